// Shaders of the cylinder, its ends and the particles on it.

import { FAINT, PLAIN } from './contrast';

/** Steps of the meridian of a closed cell, as the server sends it. */
export const STEPS = 96;

export const surfaceVertex = /* glsl */ `
in vec2 place; // theta, and share of the length
in vec4 skin;  // radius, height, and the normal outwards and upwards
in vec2 bend;  // the curvatures around the axis and along the meridian
uniform mat4 toScreen;
uniform float turn;
uniform float span;
uniform vec3 eye;
out vec2 at;
out vec3 outward;
out vec3 body;
out float curved; // in the direction of the view
void main() {
  at = vec2(place.x, place.y * span);
  vec2 way = vec2(sin(place.x - turn), cos(place.x - turn));
  outward = vec3(skin.z * way.x, skin.w, skin.z * way.y);
  body = vec3(skin.x * way.x, skin.y, skin.x * way.y);
  float around = dot(vec3(way.y, 0.0, -way.x), eye);
  float along = dot(vec3(-skin.w * way.x, skin.z, -skin.w * way.y), eye);
  curved = (bend.x * around * around + bend.y * along * along) / max(around * around + along * along, 1e-4);
  gl_Position = toScreen * vec4(body, 1.0);
}`;

export const surfaceFragment = /* glsl */ `
precision highp float;
precision highp int;
precision highp sampler2D;
uniform sampler2D order;   // P_z and its contrast before; both now
uniform sampler2D vector;  // P_theta and P_z before; both now
uniform sampler2D colours;
uniform float wheeled;     // 1 if colours show the direction of P
uniform vec3 wheel[4];     // its colours as light
uniform vec2 gamma;        // of the light, and the share of it where P vanishes
uniform ivec2 size;        // n_z, n_theta
uniform float cell;        // the period along the chart
uniform float closed;      // 1 for a closed surface
uniform float axial;       // 0 on a sphere
uniform vec3 eye;          // towards the viewer, or horizontally so for the cylinder
uniform vec3 middle;       // of the brush on a closed surface, as body
uniform float mixing;
uniform float radius;      // device pixels of the cylinder's radius
uniform float pixel;       // device pixels of a CSS pixel
uniform float tilt;
uniform vec3 zone;
uniform vec3 ink;
uniform vec4 brush;        // theta, z, radius, shown or not
uniform float inner;       // 1 if the wall is seen from inside
uniform vec3 paper;
in vec2 at;
in vec3 outward;
in vec3 body;
in float curved;
out vec4 colour;

vec4 cubic(float t) {
  return 0.5 * vec4(
    t * (-1.0 + t * (2.0 - t)),
    2.0 + t * t * (3.0 * t - 5.0),
    t * (1.0 + t * (4.0 - 3.0 * t)),
    t * t * (t - 1.0));
}

vec2 value(sampler2D field, vec2 where) {
  vec2 x = vec2(where.y / cell, where.x / 6.283185307179586) * vec2(size);
  vec2 whole = floor(x);
  vec4 across = cubic(x.x - whole.x);
  vec4 along = cubic(x.y - whole.y);
  ivec2 base = (ivec2(whole) + size) % size;
  ivec4 i = (ivec4(base.x) + ivec4(-1, 0, 1, 2) + size.x) % size.x;
  ivec4 j = (ivec4(base.y) + ivec4(-1, 0, 1, 2) + size.y) % size.y;
  vec4 sum = vec4(0.0);
  for (int m = 0; m < 4; m++) {
    sum += along[m] * (
      across.x * texelFetch(field, ivec2(i.x, j[m]), 0) +
      across.y * texelFetch(field, ivec2(i.y, j[m]), 0) +
      across.z * texelFetch(field, ivec2(i.z, j[m]), 0) +
      across.w * texelFetch(field, ivec2(i.w, j[m]), 0));
  }
  return mix(sum.xy, sum.zw, mixing);
}

// The colour of an order vector, as directionOf in palette.ts.
vec3 direction(vec2 P) {
  float place = mod(atan(P.y, P.x + 1e-7) / 1.5707963267948966, 4.0);
  int below = int(floor(place)) % 4;
  vec3 hue = mix(wheel[below], wheel[(below + 1) % 4], fract(place));
  return pow(hue * mix(gamma.y, 1.0, min(length(P), 1.0)), vec3(1.0 / gamma.x));
}

void main() {
  vec2 P = value(order, at);
  float slant = dot(outward, eye);
  float facing = max(inner > 0.5 ? -slant : slant, 0.0);
  vec3 base = texture(colours, vec2(0.5 + 0.5 * clamp(P.x, -1.0, 1.0), 0.5)).rgb;
  if (wheeled > 0.5) base = direction(value(vector, at));
  float light = 0.50 + 0.50 * pow(facing, 0.55);
  float gloss = exp(-18.0 * (outward.x + 0.34) * (outward.x + 0.34) - 3.0 * outward.y * outward.y);
  colour = vec4(base * light + 0.045 * gloss * (1.0 - inner), 1.0);
  // What is in front of it stands out.
  colour.rgb = mix(colour.rgb, paper, 0.6 * inner);

  // The indifferent zone: of constant width, absent where filaments on its two sides do not differ in direction.
  float slope = length(vec2(dFdx(P.x), dFdy(P.x))) + 1e-7;
  float line = 1.0 - smoothstep(1.25 * pixel - 0.6, 1.25 * pixel + 0.6, abs(P.x) / slope);
  line *= clamp((P.y - ${FAINT.toFixed(4)}) / ${(PLAIN - FAINT).toFixed(4)}, 0.0, 1.0);
  colour.rgb = mix(colour.rgb, zone * (0.72 + 0.28 * sqrt(facing)), line);

  vec2 off = at - brush.xy;
  off = vec2(off.x - 6.283185307179586 * round(off.x / 6.283185307179586), off.y - cell * round(off.y / cell));
  // On a closed surface a distance is straight through space, as that of a region.
  float distance = closed > 0.5 ? length(body - middle) : length(off);
  // Not fwidth, which would show the seam.
  float across = 1.0 / (radius * max(facing, 0.15));
  float ring = 1.0 - smoothstep(0.5 * pixel, 0.5 * pixel + 1.2, abs(distance - brush.z) / across);
  float inside = 1.0 - smoothstep(0.0, 1.0, (distance - brush.z) / across);
  colour.rgb = mix(colour.rgb, vec3(1.0), brush.w * (0.9 * ring + 0.14 * inside * (1.0 - ring)));

  // Outline, drawn inwards so that it needs no multisampling.
  float side = radius * (1.0 - abs(outward.x));
  float end = min(at.y, cell - at.y) * radius * cos(tilt);
  if (closed > 0.5) {
    // The distance to the silhouette, where the surface is as curved as a circle seen from the side. The outermost
    // pixel is transparent, so that a round edge needs no multisampling either.
    float edge = radius * (1.0 - sqrt(max(1.0 - slant * slant, 0.0))) / max(curved, 0.02);
    colour.rgb = mix(ink, colour.rgb, smoothstep(0.8 * pixel, 2.2 * pixel, edge));
    colour.a = smoothstep(0.0, 1.2, edge);
    colour.rgb *= colour.a;
  } else {
    colour.rgb = mix(ink, colour.rgb, smoothstep(0.0, 1.4 * pixel, min(side, end)));
  }
}`;

export const endVertex = /* glsl */ `
in vec2 place; // angle, and distance from the axis
uniform mat4 toScreen;
uniform float height;
out vec2 disc;
void main() {
  disc = place.y * vec2(sin(place.x), cos(place.x));
  gl_Position = toScreen * vec4(disc.x, height, disc.y, 1.0);
}`;

export const endFragment = /* glsl */ `
precision highp float;
uniform vec3 paper;
uniform vec3 shade;
uniform vec3 ink;
uniform float radius;
uniform float pixel;
uniform float tilt;
in vec2 disc;
out vec4 colour;
void main() {
  float r = length(disc);
  vec3 soft = mix(paper, shade, smoothstep(0.35, 1.0, r) * (0.75 + 0.25 * disc.y));
  // Distance to the rim in pixels: the disc is seen from the side.
  float steep = length(vec2(disc.x, disc.y / max(abs(sin(tilt)), 0.02))) / max(r, 1e-3);
  float rim = radius * (1.0 - r) / max(steep, 1.0);
  colour = vec4(mix(ink, soft, smoothstep(0.0, 1.4 * pixel, rim)), 1.0);
}`;

export const trailVertex = /* glsl */ `
precision highp float;
in vec2 place; // row, side
in vec4 ahead; // the particle's trail a row before, here and a row behind
in vec4 here;
in vec4 behind;
uniform mat4 toScreen;
uniform float turn;
uniform float cell;
uniform float closed;
uniform vec3 eye;
uniform vec4 profile[${STEPS + 1}];
uniform float phase;
uniform float rows;
uniform float width;
uniform vec2 screen; // device pixels
out float opacity;
out float height;

vec3 onSurface(vec2 p, out vec3 normal) {
  vec2 way = vec2(sin(p.x - turn), cos(p.x - turn));
  if (closed < 0.5) {
    normal = vec3(way.x, 0.0, way.y);
    return vec3(1.004 * way.x, p.y - 0.5 * cell, 1.004 * way.y);
  }
  // The chart of a closed surface goes on behind the poles.
  float y = mod(p.y, cell) / cell * ${(2 * STEPS).toFixed(1)};
  if (y > ${STEPS.toFixed(1)}) {
    y = ${(2 * STEPS).toFixed(1)} - y;
    way = -way;
  }
  int k = min(int(y), ${STEPS - 1});
  vec4 skin = mix(profile[k], profile[k + 1], y - float(k));
  normal = vec3(skin.z * way.x, skin.w, skin.z * way.y);
  return 1.004 * vec3(skin.x * way.x, skin.y, skin.x * way.y);
}

void main() {
  vec3 normal, other;
  vec4 point = toScreen * vec4(onSurface(here.xy, normal), 1.0);
  bool first = place.x < 0.5;
  bool last = place.x > rows - 1.5;
  vec2 a = (toScreen * vec4(onSurface(first ? here.xy : ahead.xy, other), 1.0)).xy;
  vec2 b = (toScreen * vec4(onSurface(last ? here.xy : behind.xy, other), 1.0)).xy;
  vec2 way = (a - b) * screen;
  float size = length(way);
  way = size > 1e-3 ? way / size : vec2(0.0, 1.0);
  float along = first ? 1.0 : max(1.0 - (place.x - 1.0 + phase) / (rows - 1.0), 0.0);
  float facing = dot(normal, eye);
  float half_width = 0.5 * width * (0.25 + 0.75 * along);
  point.xy += vec2(-way.y, way.x) * place.y * 2.0 * half_width / screen;
  gl_Position = point;
  height = closed < 0.5 ? here.y : 0.0;
  opacity = here.z * pow(along, 1.5) * smoothstep(0.0, 0.45, facing) * (0.25 + 0.75 * smoothstep(0.0, 0.35, here.w));
}`;

export const trailFragment = /* glsl */ `
precision highp float;
uniform float cell;
uniform vec3 tint;
in float opacity;
in float height;
out vec4 colour;
void main() {
  if (height < 0.0 || height > cell) discard;
  colour = vec4(tint, 0.85 * opacity);
}`;


export const markVertex = /* glsl */ `
in vec2 corner;
in vec3 skin;   // theta, radius, height
in vec3 kind;   // the normal outwards and upwards, and the index
uniform mat4 toScreen;
uniform float turn;
uniform float size;   // device pixels
uniform vec2 screen;
uniform vec3 eye;
out vec2 disc;
out float index;
out float front;
void main() {
  vec2 way = vec2(sin(skin.x - turn), cos(skin.x - turn));
  front = dot(vec3(kind.x * way.x, kind.y, kind.x * way.y), eye);
  gl_Position = toScreen * vec4(skin.y * way.x, skin.z, skin.y * way.y, 1.0);
  gl_Position.xy += corner * 2.0 * size / screen;
  disc = corner;
  index = kind.z;
}`;

export const markFragment = /* glsl */ `
precision highp float;
uniform float size;
uniform vec3 dark;
in vec2 disc;
in float index;
in float front;
out vec4 colour;
void main() {
  if (front <= 0.0) discard;
  float soft = 1.0 / size;
  float r = length(disc);
  vec3 face = index > 0.0 ? vec3(1.0) : dark;
  vec3 line = index > 0.0 ? dark : vec3(1.0);
  vec2 d = abs(disc);
  float bar = max(d.x / 0.5, d.y / 0.13);
  if (index > 0.0) bar = min(bar, max(d.y / 0.5, d.x / 0.13));
  vec3 tint = mix(line, face, smoothstep(0.9, 1.1 + soft, bar));
  tint = mix(tint, dark, smoothstep(0.8 - soft, 0.8, r));
  colour = vec4(tint, 1.0 - smoothstep(1.0 - soft, 1.0, r));
}`;
