// The particles on the cylinder: ribbons of constant width on the screen.

import * as THREE from 'three';
import { TRAIL, type Particles } from './particles';
import { trailFragment, trailVertex } from './shaders';

export class Trails {
  readonly mesh: THREE.Mesh;
  /** The rows of the trails, every position twice, with a row before the first and after the last. */
  private readonly rows: Float32Array;
  private readonly buffer: THREE.InterleavedBuffer;
  private readonly material: THREE.ShaderMaterial;

  constructor(
    private readonly particles: Particles,
    shared: Record<string, THREE.IUniform>,
  ) {
    const { count } = particles;
    const place = new Float32Array(4 * TRAIL * count);
    const index = new Uint32Array(6 * (TRAIL - 1) * count);
    for (let k = 0, v = 0, q = 0; k < TRAIL; k++) {
      for (let n = 0; n < count; n++, v += 2) {
        place.set([k, -1, k, 1], 2 * v);
        if (k + 1 === TRAIL) continue;
        const w = v + 2 * count;
        index.set([v, v + 1, w, w, v + 1, w + 1], q);
        q += 6;
      }
    }
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('place', new THREE.BufferAttribute(place, 2));
    geometry.setIndex(new THREE.BufferAttribute(index, 1));
    this.rows = new Float32Array(8 * count * (TRAIL + 2));
    this.buffer = new THREE.InterleavedBuffer(this.rows, 4).setUsage(THREE.DynamicDrawUsage);
    // One buffer, read at three offsets: with a texture read by the vertex shader, OpenGL ES on an NVIDIA GPU
    // showed nothing.
    for (const [row, name] of ['ahead', 'here', 'behind'].entries()) {
      geometry.setAttribute(name, new THREE.InterleavedBufferAttribute(this.buffer, 4, 8 * count * row));
    }
    this.material = new THREE.ShaderMaterial({
      glslVersion: THREE.GLSL3,
      vertexShader: trailVertex,
      fragmentShader: trailFragment,
      uniforms: {
        toScreen: shared.toScreen,
        turn: shared.turn,
        cell: shared.cell,
        closed: shared.closed,
        eye: shared.eye,
        profile: shared.profile,
        phase: { value: 0 },
        rows: { value: TRAIL },
        width: { value: 2.4 },
        screen: { value: new THREE.Vector2(1, 1) },
        tint: { value: new THREE.Vector3(1, 1, 1) },
      },
      transparent: true,
      depthTest: false, // trails on the far side are transparent
      depthWrite: false,
      side: THREE.DoubleSide,
    });
    this.mesh = new THREE.Mesh(geometry, this.material);
    this.mesh.frustumCulled = false;
    this.mesh.renderOrder = 2;
  }

  update(width: number, height: number, pixel: number): void {
    const { uniforms } = this.material;
    const { count, data, phase } = this.particles;
    uniforms.phase.value = phase;
    uniforms.width.value = 2.4 * pixel;
    uniforms.screen.value.set(width * pixel, height * pixel);
    for (let from = 0, to = 8 * count; from < data.length; from += 4, to += 8) {
      for (let j = 0; j < 4; j++) this.rows[to + j] = this.rows[to + 4 + j] = data[from + j];
    }
    this.buffer.needsUpdate = true;
  }
}
