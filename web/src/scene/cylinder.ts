// The cell as a solid, drawn with WebGL.

import * as THREE from 'three';
import type { Defect, Palette } from '../protocol';
import { Defects } from './defects';
import type { Fields } from './fields';
import { lightOf, paletteTable, rgb, solidColours } from './palette';
import type { Particles } from './particles';
import { Opened } from './opened';
import { endFragment, endVertex, STEPS, surfaceFragment, surfaceVertex } from './shaders';
import type { Surface } from './surface';
import type { Tracers } from './tracers';
import { Trails } from './trails';
import type { View } from './view';

const AROUND = 128;
const COLOURS = 1024;

export interface BrushMark {
  theta: number;
  z: number;
  radius: number;
  shown: boolean;
}

const linear = (hex: string): THREE.Vector3 => new THREE.Vector3(...rgb(hex)).divideScalar(255);

export class Cylinder {
  readonly renderer: THREE.WebGLRenderer;
  private readonly scene = new THREE.Scene();
  private readonly camera = new THREE.OrthographicCamera();
  private readonly uniforms: Record<string, THREE.IUniform>;
  private readonly surface: THREE.Mesh;
  private readonly end: THREE.Mesh;
  private readonly trails: Trails;
  private readonly opened: Opened;
  private readonly defects: Defects;
  private shown: Surface | null = null;
  private order: THREE.DataTexture | null = null;
  private vector: THREE.DataTexture | null = null;
  private readonly colours: THREE.DataTexture;
  private version = -1;

  /** Throws if WebGL 2 is not available. */
  constructor(
    canvas: HTMLCanvasElement,
    particles: Particles,
    tracers: Tracers,
    palette: Palette,
    dark: boolean,
    software: boolean,
  ) {
    this.renderer = new THREE.WebGLRenderer({ canvas, alpha: true, antialias: !software, stencil: false });
    this.renderer.setClearColor(0, 0);
    this.renderer.outputColorSpace = THREE.LinearSRGBColorSpace; // the palette is shown as it is
    this.colours = new THREE.DataTexture(paletteTable(palette, COLOURS), COLOURS, 1);
    this.colours.magFilter = this.colours.minFilter = THREE.LinearFilter;
    this.colours.needsUpdate = true;
    this.uniforms = {
      order: { value: null },
      vector: { value: null },
      colours: { value: this.colours },
      wheeled: { value: 0 },
      wheel: { value: Array.from({ length: 4 }, () => new THREE.Vector3()) },
      gamma: { value: new THREE.Vector2(1, 0) },
      size: { value: new THREE.Vector2(1, 1) },
      toScreen: { value: new THREE.Matrix4() },
      turn: { value: 0 },
      tilt: { value: 0 },
      inner: { value: 0 },
      cell: { value: 1 },
      span: { value: 1 },
      closed: { value: 0 },
      axial: { value: 1 },
      eye: { value: new THREE.Vector3(0, 0, 1) },
      middle: { value: new THREE.Vector3() },
      profile: { value: Array.from({ length: STEPS + 1 }, () => new THREE.Vector4()) },
      mixing: { value: 1 },
      radius: { value: 1 },
      pixel: { value: 1 },
      height: { value: 0 },
      brush: { value: new THREE.Vector4() },
      zone: { value: linear(palette.zone) },
      ink: { value: new THREE.Vector3() },
      paper: { value: new THREE.Vector3() },
      shade: { value: new THREE.Vector3() },
    };
    this.surface = this.mesh(new THREE.BufferGeometry(), surfaceVertex, surfaceFragment, THREE.FrontSide);
    this.end = this.mesh(ring(0, 1), endVertex, endFragment, THREE.DoubleSide);
    this.trails = new Trails(particles, this.uniforms);
    this.opened = new Opened(tracers, this.uniforms);
    this.defects = new Defects(this.uniforms);
    this.scene.add(this.surface, this.end, this.trails.mesh, this.opened.group, this.defects.mesh);
    this.setPalette(palette);
    this.setDark(dark);
  }

  private mesh(
    geometry: THREE.BufferGeometry,
    vertexShader: string,
    fragmentShader: string,
    side: THREE.Side,
  ): THREE.Mesh {
    const { uniforms } = this;
    const material = new THREE.ShaderMaterial({
      glslVersion: THREE.GLSL3,
      vertexShader,
      fragmentShader,
      uniforms,
      side,
    });
    const mesh = new THREE.Mesh(geometry, material);
    mesh.frustumCulled = false;
    return mesh;
  }

  setPalette(palette: Palette): void {
    (this.colours.image.data as Uint8Array).set(paletteTable(palette, COLOURS));
    this.colours.needsUpdate = true;
    const { uniforms } = this;
    uniforms.zone.value = linear(palette.zone);
    uniforms.wheeled.value = palette.wheel ? 1 : 0;
    if (!palette.wheel) return;
    uniforms.gamma.value.set(palette.wheel.gamma, palette.wheel.darkest);
    lightOf(palette.wheel).forEach((light, k) => (uniforms.wheel.value as THREE.Vector3[])[k].fromArray(light));
    this.version = -1; // this palette needs a texture that others do not
  }

  setDark(dark: boolean): void {
    this.opened.setDark(dark);
    for (const [name, colour] of Object.entries(solidColours(dark))) this.uniforms[name].value = linear(colour);
  }

  draw(
    now: number,
    fields: Fields,
    mixing: number,
    view: View,
    mark: BrushMark,
    defects: Defect[],
    ratio: number,
  ): void {
    const { width, height } = view;
    const { renderer, camera, uniforms } = this;
    if (renderer.getPixelRatio() !== ratio) renderer.setPixelRatio(ratio);
    renderer.getSize(size);
    if (size.x !== width || size.y !== height) renderer.setSize(width, height, false);
    if (fields.empty) {
      renderer.clear();
      return;
    }
    this.upload(fields);
    const { surface } = fields;
    this.build(surface);
    const { scale, tilt } = view;
    camera.left = -width / 2 / scale;
    camera.right = -camera.left;
    camera.top = height / 2 / scale;
    camera.bottom = -camera.top;
    const far = 4 * surface.half + 10;
    camera.near = 0.1;
    camera.far = 2 * far;
    camera.position.set(0, view.centre + far * Math.sin(tilt), far * Math.cos(tilt));
    camera.lookAt(0, view.centre, 0);
    camera.updateProjectionMatrix();
    camera.updateMatrixWorld();
    uniforms.toScreen.value.multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse);
    uniforms.turn.value = view.turn;
    uniforms.tilt.value = tilt;
    uniforms.mixing.value = mixing;
    uniforms.radius.value = scale * ratio;
    uniforms.pixel.value = ratio;
    uniforms.eye.value.set(0, surface.closed ? Math.sin(tilt) : 0, surface.closed ? Math.cos(tilt) : 1);
    const { open } = view;
    // Of the closed cell the near end is seen, of the opened one the far end.
    uniforms.height.value = (tilt >= 0 !== open ? 1 : -1) * surface.half;
    uniforms.inner.value = open ? 1 : 0;
    (this.surface.material as THREE.Material).side = open ? THREE.BackSide : THREE.FrontSide;
    this.trails.mesh.visible = !open;
    this.opened.group.visible = open;
    this.end.visible = !surface.closed;
    this.defects.mesh.visible = surface.closed && !open;
    this.defects.update(defects, surface, width, height, ratio);
    const { r, z } = surface.skin(mark.z);
    uniforms.middle.value.set(r * Math.sin(mark.theta - view.turn), z, r * Math.cos(mark.theta - view.turn));
    uniforms.brush.value.set(mark.theta, mark.z, mark.radius, mark.shown ? 1 : 0);
    if (open) this.opened.update(now, width, height, ratio);
    else this.trails.update(width, height, ratio);
    renderer.render(this.scene, camera);
  }

  /** Set the solid to that of a surface. */
  private build(surface: Surface): void {
    if (surface === this.shown) return;
    this.shown = surface;
    const { uniforms } = this;
    uniforms.cell.value = surface.period;
    uniforms.span.value = surface.length;
    uniforms.closed.value = surface.closed ? 1 : 0;
    uniforms.axial.value = surface.axial ? 1 : 0;
    const { profile } = surface;
    if (surface.closed) (uniforms.profile.value as THREE.Vector4[]).forEach((each, k) => each.fromArray(profile, 4 * k));
    this.surface.geometry.dispose();
    this.surface.geometry = skin(profile);
  }

  private upload(fields: Fields): void {
    if (this.version === fields.version) return;
    this.version = fields.version;
    const { n_theta, n_z } = fields;
    this.uniforms.size.value.set(n_z, n_theta);
    this.order = this.uniforms.order.value = texture(this.order, fields.order, n_z, n_theta);
    if (this.uniforms.wheeled.value) this.vector = this.uniforms.vector.value = texture(this.vector, fields.vector, n_z, n_theta);
  }
}

/** A texture of these values, the one before if it has them already; to be uploaded. */
function texture(before: THREE.DataTexture | null, values: Float32Array, width: number, height: number): THREE.DataTexture {
  let made = before;
  if (!made || made.image.width !== width || made.image.height !== height || made.image.data !== values) {
    made?.dispose();
    made = new THREE.DataTexture(values as Float32Array<ArrayBuffer>, width, height, THREE.RGBAFormat, THREE.FloatType);
  }
  made.needsUpdate = true;
  return made;
}

const size = new THREE.Vector2();

/** A band around the axis: (angle, from `low` to `high`) as the attribute `place`. */
function ring(low: number, high: number): THREE.BufferGeometry {
  const place = new Float32Array(4 * (AROUND + 1));
  const index: number[] = [];
  for (let k = 0, v = 0; k <= AROUND; k++, v += 2) {
    const angle = (2 * Math.PI * k) / AROUND;
    place.set([angle, low, angle, high], 4 * k);
    if (k < AROUND) index.push(v, v + 2, v + 1, v + 1, v + 2, v + 3);
  }
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('place', new THREE.BufferAttribute(place, 2));
  geometry.setIndex(index);
  return geometry;
}

/** The solid around the axis that rows of (radius, height, normal outwards and upwards) make. */
function skin(profile: Float32Array): THREE.BufferGeometry {
  const rows = profile.length / 4;
  const place = new Float32Array(2 * rows * (AROUND + 1));
  const skins = new Float32Array(4 * rows * (AROUND + 1));
  const bends = new Float32Array(2 * rows * (AROUND + 1));
  const curvatures = Array.from({ length: rows }, (_, j) => bend(profile, j));
  const index: number[] = [];
  for (let k = 0, v = 0; k <= AROUND; k++) {
    for (let j = 0; j < rows; j++, v++) {
      bends.set(curvatures[j], 2 * v);
      place.set([(2 * Math.PI * k) / AROUND, j / (rows - 1)], 2 * v);
      skins.set(profile.subarray(4 * j, 4 * j + 4), 4 * v);
      if (k < AROUND && j + 1 < rows) index.push(v, v + rows, v + 1, v + 1, v + rows, v + rows + 1);
    }
  }
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('place', new THREE.BufferAttribute(place, 2));
  geometry.setAttribute('skin', new THREE.BufferAttribute(skins, 4));
  geometry.setAttribute('bend', new THREE.BufferAttribute(bends, 2));
  geometry.setIndex(index);
  return geometry;
}

/** The curvatures of row j, around the axis and along the meridian: how fast the normal turns. */
function bend(profile: Float32Array, j: number): [number, number] {
  const last = profile.length / 4 - 1;
  const [below, above] = [4 * Math.max(0, j - 1), 4 * Math.min(last, j + 1)];
  const angle = (at: number): number => Math.atan2(profile[at + 3], profile[at + 2]);
  const length = Math.hypot(profile[above] - profile[below], profile[above + 1] - profile[below + 1]);
  const along = Math.abs(angle(above) - angle(below)) / (length || 1);
  const [r, out] = [profile[4 * j], profile[4 * j + 2]];
  return [r > 1e-3 ? out / r : along, along];
}
