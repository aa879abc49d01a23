// The particles on the cylinder: ribbons as wide on the screen at every distance.

import * as THREE from 'three';
import { TRAIL, type Particles } from './particles';
import { trailFragment, trailVertex } from './shaders';

export class Trails {
  readonly mesh: THREE.Mesh;
  private readonly texture: THREE.DataTexture;
  private readonly material: THREE.ShaderMaterial;

  constructor(
    private readonly particles: Particles,
    shared: Record<string, THREE.IUniform>,
  ) {
    const { count } = particles;
    const place = new Float32Array(3 * 2 * TRAIL * count);
    const index = new Uint32Array(6 * (TRAIL - 1) * count);
    for (let n = 0, v = 0, q = 0; n < count; n++) {
      for (let k = 0; k < TRAIL; k++, v += 2) {
        place.set([n, k, -1, n, k, 1], 3 * v);
        if (k + 1 === TRAIL) continue;
        index.set([v, v + 1, v + 2, v + 2, v + 1, v + 3], q);
        q += 6;
      }
    }
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('place', new THREE.BufferAttribute(place, 3));
    geometry.setIndex(new THREE.BufferAttribute(index, 1));
    this.texture = new THREE.DataTexture(particles.data, count, TRAIL, THREE.RGBAFormat, THREE.FloatType);
    this.material = new THREE.ShaderMaterial({
      glslVersion: THREE.GLSL3,
      vertexShader: trailVertex,
      fragmentShader: trailFragment,
      uniforms: {
        toScreen: shared.toScreen,
        turn: shared.turn,
        cell: shared.cell,
        trail: { value: this.texture },
        phase: { value: 0 },
        rows: { value: TRAIL },
        width: { value: 2.4 },
        screen: { value: new THREE.Vector2(1, 1) },
        tint: { value: new THREE.Vector3(1, 1, 1) },
      },
      transparent: true,
      depthWrite: false,
      side: THREE.DoubleSide,
    });
    this.mesh = new THREE.Mesh(geometry, this.material);
    this.mesh.frustumCulled = false;
    this.mesh.renderOrder = 2;
  }

  update(width: number, height: number, pixel: number): void {
    const { uniforms } = this.material;
    uniforms.phase.value = this.particles.phase;
    uniforms.width.value = 2.4 * pixel;
    uniforms.screen.value.set(width * pixel, height * pixel);
    this.texture.needsUpdate = true;
  }
}
