// The defects of P on a closed cell: small discs with a plus or a minus.

import * as THREE from 'three';
import type { Defect } from '../protocol';
import { markFragment, markVertex } from './shaders';
import type { Surface } from './surface';

/** Most marks that are drawn. */
const MOST = 128;
/** CSS pixels from the middle to the edge of a mark. */
const SIZE = 5.5;

export class Defects {
  readonly mesh: THREE.Mesh;
  private readonly skin = new Float32Array(3 * 4 * MOST);
  private readonly kind = new Float32Array(3 * 4 * MOST);
  private readonly geometry = new THREE.BufferGeometry();
  private readonly own = {
    size: { value: SIZE },
    screen: { value: new THREE.Vector2(1, 1) },
    dark: { value: new THREE.Vector3(0.106, 0.09, 0.125) },
  };
  private shown: Defect[] | null = null;

  constructor(shared: Record<string, THREE.IUniform>) {
    const corner = new Float32Array(2 * 4 * MOST);
    const index = new Uint16Array(6 * MOST);
    for (let n = 0, v = 0; n < MOST; n++, v += 4) {
      corner.set([-1, -1, 1, -1, 1, 1, -1, 1], 2 * v);
      index.set([v, v + 1, v + 2, v, v + 2, v + 3], 6 * n);
    }
    this.geometry.setAttribute('corner', new THREE.BufferAttribute(corner, 2));
    this.geometry.setAttribute('skin', new THREE.BufferAttribute(this.skin, 3));
    this.geometry.setAttribute('kind', new THREE.BufferAttribute(this.kind, 3));
    this.geometry.setIndex(new THREE.BufferAttribute(index, 1));
    const material = new THREE.ShaderMaterial({
      glslVersion: THREE.GLSL3,
      vertexShader: markVertex,
      fragmentShader: markFragment,
      uniforms: { toScreen: shared.toScreen, turn: shared.turn, eye: shared.eye, ...this.own },
      transparent: true,
      depthTest: false, // those on the far side are left out by their normals
      depthWrite: false,
      side: THREE.DoubleSide,
    });
    this.mesh = new THREE.Mesh(this.geometry, material);
    this.mesh.frustumCulled = false;
    this.mesh.renderOrder = 3;
  }

  update(defects: Defect[], surface: Surface, width: number, height: number, pixel: number): void {
    this.own.size.value = SIZE * pixel;
    this.own.screen.value.set(width * pixel, height * pixel);
    if (defects === this.shown) return;
    this.shown = defects;
    const count = Math.min(MOST, defects.length);
    for (let n = 0; n < count; n++) {
      const [index, theta, s] = defects[n];
      const { r, z, out, up } = surface.skin(s);
      for (let v = 4 * n; v < 4 * n + 4; v++) {
        this.skin.set([theta, r, z], 3 * v);
        this.kind.set([out, up, index], 3 * v);
      }
    }
    this.geometry.getAttribute('skin').needsUpdate = true;
    this.geometry.getAttribute('kind').needsUpdate = true;
    this.geometry.setDrawRange(0, 6 * count);
  }
}
