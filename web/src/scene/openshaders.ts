// Shaders of what is inside the opened cylinder.

export const tracerVertex = /* glsl */ `
precision highp float;
in vec2 place; // row, side
in vec4 ahead; // the tracer's trail a row before, here and a row behind: x, y, z, share
in vec4 here;
in vec4 behind;
uniform mat4 toScreen;
uniform float turn;
uniform float cell;
uniform float mixing;
uniform float rows;
uniform float width;
uniform vec2 screen; // device pixels
out vec3 at;         // height, depth, share
out vec3 ribbon;     // along, side, half of the width in pixels

vec3 turned(vec3 p) {
  // Just inside the wall, which consists of flat pieces.
  vec2 xy = p.xy * min(1.0, 0.985 / max(length(p.xy), 1e-6));
  return vec3(xy.y * cos(turn) - xy.x * sin(turn), p.z - 0.5 * cell, xy.x * cos(turn) + xy.y * sin(turn));
}

void main() {
  bool first = place.x < 0.5;
  bool last = place.x > rows - 1.5;
  vec4 now = first ? mix(behind, here, mixing) : here;
  vec3 where = turned(now.xyz);
  vec4 point = toScreen * vec4(where, 1.0);
  vec2 a = (toScreen * vec4(turned(first ? here.xyz : ahead.xyz), 1.0)).xy;
  vec2 b = (toScreen * vec4(turned(last ? here.xyz : behind.xyz), 1.0)).xy;
  vec2 way = (a - b) * screen;
  float size = length(way);
  way = size > 1e-3 ? way / size : vec2(0.0, 1.0);
  float along = first ? 1.0 : max(1.0 - (place.x - 1.0 + mixing) / (rows - 1.0), 0.0);
  float half_width = 0.5 * width * (0.45 + 0.55 * along);
  point.xy += vec2(-way.y, way.x) * place.y * 2.0 * half_width / screen;
  // A tracer at rest is a dot.
  if (first) point.xy += way * 2.0 * half_width / screen;
  gl_Position = point;
  at = vec3(now.z, where.z, now.w);
  ribbon = vec3(along, place.y, half_width);
}`;

export const tracerFragment = /* glsl */ `
precision highp float;
uniform sampler2D colours;
uniform float cell;
uniform float pixel;
uniform vec3 ink;
uniform vec3 grey;
in vec3 at;
in vec3 ribbon;
out vec4 colour;
void main() {
  if (at.x < 0.0 || at.x > cell) discard;
  float share = clamp(at.z, -1.0, 1.0);
  vec3 tint = texture(colours, vec2(0.5 + 0.5 * share, 0.5)).rgb;
  tint = mix(grey, tint, smoothstep(0.05, 0.5, abs(share)));
  // A dark edge sets it off against a wall of its own colour.
  float inwards = (1.0 - abs(ribbon.y)) * ribbon.z;
  tint = mix(ink, tint, smoothstep(0.5 * pixel, 1.3 * pixel, inwards));
  colour = vec4(tint, smoothstep(0.0, 0.9 * pixel, inwards) * pow(ribbon.x, 1.2) * (0.75 + 0.25 * at.y));
}`;

export const sectionVertex = /* glsl */ `
in vec2 place; // angle, distance from the axis
in vec2 shares;
uniform mat4 toScreen;
uniform float turn;
uniform float mixing;
out vec2 disc;
out float share;
void main() {
  disc = place.y * vec2(sin(place.x - turn), cos(place.x - turn));
  share = mix(shares.x, shares.y, mixing);
  gl_Position = toScreen * vec4(0.985 * disc.x, 0.0, 0.985 * disc.y, 1.0);
}`;

export const sectionFragment = /* glsl */ `
precision highp float;
uniform sampler2D colours;
uniform vec3 ink;
uniform float radius;
uniform float pixel;
uniform float tilt;
in vec2 disc;
in float share;
out vec4 colour;
void main() {
  vec3 base = texture(colours, vec2(0.5 + 0.5 * clamp(share, -1.0, 1.0), 0.5)).rgb;
  float r = length(disc);
  float steep = length(vec2(disc.x, disc.y / max(abs(sin(tilt)), 0.02))) / max(r, 1e-3);
  float rim = radius * (1.0 - r) / max(steep, 1.0);
  colour = vec4(mix(ink, base, smoothstep(0.5 * pixel, 1.7 * pixel, rim)), 1.0);
}`;

export const rimVertex = /* glsl */ `
in vec2 place; // angle, and height from 0 to 1
uniform mat4 toScreen;
uniform float cell;
void main() {
  gl_Position = toScreen * vec4(sin(place.x), (place.y - 0.5) * cell, cos(place.x), 1.0);
}`;

export const rimFragment = /* glsl */ `
precision highp float;
uniform vec3 line;
out vec4 colour;
void main() {
  colour = vec4(line, 1.0);
}`;
