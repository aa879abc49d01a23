// What is seen in the opened cylinder: tracers as ribbons, the section in the middle, and the rim in front.

import * as THREE from 'three';
import { rimFragment, rimVertex, sectionFragment, sectionVertex, tracerFragment, tracerVertex } from './openshaders';
import { ROWS, type Tracers } from './tracers';

/** CSS pixels across a ribbon at its head, its soft edge included. */
const WIDTH = 5;
const AROUND = 96;

export class Opened {
  readonly group = new THREE.Group();
  private ribbons: THREE.Mesh | null = null;
  private section: THREE.Mesh | null = null;
  /** Every place twice, with a row before the first and after the last. */
  private rows = new Float32Array(0);
  private count = 0;
  private shares = new Float32Array(0);
  private version = -1;
  private readonly own = {
    mixing: { value: 1 },
    rows: { value: ROWS },
    width: { value: WIDTH },
    screen: { value: new THREE.Vector2(1, 1) },
    grey: { value: new THREE.Vector3(0.6, 0.6, 0.6) },
    line: { value: new THREE.Vector3() },
  };
  private readonly uniforms: Record<string, THREE.IUniform>;

  constructor(
    private readonly tracers: Tracers,
    shared: Record<string, THREE.IUniform>,
  ) {
    // The way between two messages is not that between two pictures.
    this.uniforms = { ...shared, ...this.own };
    const rim = new THREE.LineSegments(rims(), this.material(rimVertex, rimFragment));
    rim.frustumCulled = false;
    this.group.add(rim);
    this.group.visible = false;
  }

  setDark(dark: boolean): void {
    this.own.line.value.setScalar(dark ? 0.55 : 0.4);
    this.own.grey.value.setScalar(dark ? 0.62 : 0.5);
  }

  update(now: number, width: number, height: number, pixel: number): void {
    const { tracers, own } = this;
    if (this.version !== tracers.version) {
      this.version = tracers.version;
      this.take();
    }
    own.mixing.value = tracers.mixing(now);
    own.width.value = WIDTH * pixel;
    own.screen.value.set(width * pixel, height * pixel);
  }

  private material(vertexShader: string, fragmentShader: string): THREE.ShaderMaterial {
    const { uniforms } = this;
    return new THREE.ShaderMaterial({
      glslVersion: THREE.GLSL3, vertexShader, fragmentShader, uniforms, side: THREE.DoubleSide,
    });
  }

  private take(): void {
    const { tracers } = this;
    if (tracers.count !== this.count || tracers.section !== this.shares) this.build();
    if (tracers.empty || !this.ribbons || !this.section) return;
    const { rows } = this;
    for (let from = 0, to = 8 * this.count; from < tracers.rows.length; from += 4, to += 8) {
      for (let j = 0; j < 4; j++) rows[to + j] = rows[to + 4 + j] = tracers.rows[from + j];
    }
    (this.ribbons.geometry.getAttribute('here') as THREE.InterleavedBufferAttribute).data.needsUpdate = true;
    this.section.geometry.getAttribute('shares').needsUpdate = true;
  }

  private build(): void {
    for (const mesh of [this.ribbons, this.section]) {
      if (!mesh) continue;
      this.group.remove(mesh);
      mesh.geometry.dispose();
      (mesh.material as THREE.Material).dispose();
    }
    this.ribbons = this.section = null;
    const { count, rings, sectors, section } = this.tracers;
    this.count = count;
    this.shares = section;
    if (!count) return;
    const ribbons = this.material(tracerVertex, tracerFragment);
    Object.assign(ribbons, { transparent: true, depthWrite: false });
    this.rows = new Float32Array(8 * count * (ROWS + 2));
    this.ribbons = new THREE.Mesh(ribbonGeometry(count, this.rows), ribbons);
    this.ribbons.renderOrder = 2;
    this.section = new THREE.Mesh(disc(rings, sectors, section), this.material(sectionVertex, sectionFragment));
    for (const mesh of [this.ribbons, this.section]) {
      mesh.frustumCulled = false;
      this.group.add(mesh);
    }
  }
}

/** Two triangles between two positions of a trail; the attributes read one buffer at three offsets. */
function ribbonGeometry(count: number, rows: Float32Array): THREE.BufferGeometry {
  const place = new Float32Array(4 * ROWS * count);
  const index = new Uint32Array(6 * (ROWS - 1) * count);
  for (let k = 0, v = 0, q = 0; k < ROWS; k++) {
    for (let n = 0; n < count; n++, v += 2) {
      place.set([k, -1, k, 1], 2 * v);
      if (k + 1 === ROWS) continue;
      const w = v + 2 * count;
      index.set([v, v + 1, w, w, v + 1, w + 1], q);
      q += 6;
    }
  }
  const geometry = new THREE.BufferGeometry();
  const buffer = new THREE.InterleavedBuffer(rows, 4).setUsage(THREE.DynamicDrawUsage);
  geometry.setAttribute('place', new THREE.BufferAttribute(place, 2));
  geometry.setIndex(new THREE.BufferAttribute(index, 1));
  for (const [row, name] of ['ahead', 'here', 'behind'].entries()) {
    geometry.setAttribute(name, new THREE.InterleavedBufferAttribute(buffer, 4, 8 * count * row));
  }
  return geometry;
}

/** The points of the section, ring after ring, with the shares of each as they are kept. */
function disc(rings: number, sectors: number, shares: Float32Array): THREE.BufferGeometry {
  const place = new Float32Array(2 * rings * sectors);
  const index: number[] = [];
  for (let i = 0; i < rings; i++) {
    for (let j = 0; j < sectors; j++) {
      const here = i * sectors + j;
      place.set([(2 * Math.PI * j) / sectors, i / (rings - 1)], 2 * here);
      if (i + 1 === rings) continue;
      const next = i * sectors + ((j + 1) % sectors);
      index.push(here, here + sectors, next, next, here + sectors, next + sectors);
    }
  }
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('place', new THREE.BufferAttribute(place, 2));
  geometry.setAttribute('shares', new THREE.BufferAttribute(shares, 2));
  geometry.setIndex(index);
  return geometry;
}

/** Both ends of the wall, as pieces of lines: (angle, height from 0 to 1). */
function rims(): THREE.BufferGeometry {
  const place: number[] = [];
  for (const end of [0, 1]) {
    for (let k = 0; k < AROUND; k++) place.push((2 * Math.PI * k) / AROUND, end, (2 * Math.PI * (k + 1)) / AROUND, end);
  }
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('place', new THREE.BufferAttribute(new Float32Array(place), 2));
  geometry.setIndex(place.slice(place.length / 2).map((_, k) => k));
  return geometry;
}
