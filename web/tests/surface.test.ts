import { describe, expect, it } from 'vitest';
import type { Frame, Outline } from '../src/protocol';
import { Stroke } from '../src/scene/brush';
import { Contrast } from '../src/scene/contrast';
import { doubled, Fields } from '../src/scene/fields';
import { flowAt } from '../src/scene/interpolate';
import { Particles, TRAIL } from '../src/scene/particles';
import { POINTS, Streamlines } from '../src/scene/streamlines';
import { ClosedSurface, CylinderSurface, nearest, type Place } from '../src/scene/surface';
import { View } from '../src/scene/view';

const TURN = 2 * Math.PI;
const STEPS = 96;
const N = 24;

/** The meridian of a spheroid of half height c, at even steps of s. */
function spheroid(c: number): { outline: Outline; length: number } {
  const fine = 20000;
  const arc = [0];
  for (let k = 1; k <= fine; k++) {
    const tau = (Math.PI * (k - 0.5)) / fine;
    arc.push(arc[k - 1] + (Math.PI / fine) * Math.hypot(Math.cos(tau), c * Math.sin(tau)));
  }
  const length = arc[fine];
  const outline: Outline = { r: [], z: [], out: [], up: [], axial: c !== 1 };
  for (let k = 0, at = 0; k <= STEPS; k++) {
    while (at < fine && arc[at] < (length * k) / STEPS) at++;
    const tau = (Math.PI * at) / fine;
    const speed = Math.hypot(Math.cos(tau), c * Math.sin(tau));
    outline.r.push(Math.abs(Math.sin(tau)));
    outline.z.push(-c * Math.cos(tau));
    outline.out.push((c * Math.sin(tau)) / speed);
    outline.up.push(-Math.cos(tau) / speed);
  }
  return { outline, length };
}

const surfaceFor = (c: number): ClosedSurface => {
  const { outline, length } = spheroid(c);
  return new ClosedSurface(outline, length);
};
const SPHERE = surfaceFor(1);
const POINTED = surfaceFor(2.5);

/** A picture of the tangent part of a vector field in space, on a sphere. */
function pictured(vector: (x: number, y: number, z: number) => [number, number, number], surface = SPHERE): Frame {
  const n_z = N + 1;
  const fields = [0, 1].map(() => new Float32Array(N * n_z));
  for (let i = 0; i < N; i++) {
    for (let j = 0; j < n_z; j++) {
      const theta = (TURN * i) / N;
      const s = (surface.length * j) / N;
      const [x, y, z] = surface.point([theta, s]);
      const [a, b, c] = vector(x, y, z);
      const { out, up } = surface.skin(s);
      fields[0][i * n_z + j] = -a * Math.sin(theta) + b * Math.cos(theta);
      fields[1][i * n_z + j] = -up * (a * Math.cos(theta) + b * Math.sin(theta)) + c * out;
    }
  }
  const [P_theta, P_z] = fields;
  const empty = new Float32Array(N);
  return {
    ...{ t: 0, frame: 0, n_theta: N, n_z, length: surface.length, peak_speed: 1, regime: null },
    ...{ P_theta, P_z, u_theta: P_theta, u_z: P_z, profile_P: empty, profile_u: empty, records: new Float64Array(0) },
  };
}

const seeded = (): (() => number) => {
  let state = 1;
  return () => (state = (state * 16807) % 2147483647) / 2147483647;
};

describe('the chart of a closed surface', () => {
  it('goes on smoothly behind the poles', () => {
    const field = pictured((x, y, z) => [z + 0.3, 0.2 * z, -x]);
    const chart = doubled(field.P_z, N, N + 1, -1);
    const rows = 2 * N;
    // Second differences along s are as small over the poles as elsewhere.
    for (let i = 0; i < N; i++) {
      for (let j = 0; j < rows; j++) {
        const at = (k: number): number => chart[i * rows + ((j + k + rows) % rows)];
        expect(Math.abs(at(1) - 2 * at(0) + at(-1))).toBeLessThan(0.05);
      }
    }
  });

  it('gives the same vector at both of its names for a place', () => {
    const fields = new Fields();
    fields.take(pictured((x, y, z) => [z, 0, -x]), SPHERE, 0);
    fields.blend(1);
    const [front, behind]: Place[] = [[0, 0], [0, 0]];
    for (const [theta, s] of [[0.4, 0.7], [2, 2.9], [5, 1.6]]) {
      flowAt(fields.flow, N, fields.n_z, fields.length, theta, s, front);
      flowAt(fields.flow, N, fields.n_z, fields.length, theta + Math.PI, 2 * SPHERE.length - s, behind);
      expect(behind[0]).toBeCloseTo(-front[0], 5);
      expect(behind[1]).toBeCloseTo(-front[1], 5);
      expect(SPHERE.within(theta + Math.PI, 2 * SPHERE.length - s)[0]).toBeCloseTo(theta, 5);
    }
  });

  it('colours a sphere by |P|, which is the same on both sides of a pole', () => {
    const fields = new Fields();
    fields.take(pictured((x, y, z) => [z, 0, -x]), SPHERE, 0);
    for (let q = 2; q < fields.order.length; q += 4) expect(fields.order[q]).toBeGreaterThanOrEqual(0);
    expect(Math.max(...fields.order.filter((_, q) => q % 4 === 3))).toBeCloseTo(0, 9); // no zones either
  });
});

describe('places on a closed surface', () => {
  it('are found again from space', () => {
    for (const surface of [SPHERE, POINTED]) {
      for (const place of [[0.3, 0.05], [4, 1.4], [2, surface.length - 0.2]] as Place[]) {
        const [theta, s] = surface.onto(surface.point(place));
        expect(theta).toBeCloseTo(place[0], 6);
        expect(s).toBeCloseTo(place[1], 3);
      }
    }
  });

  it('are carried over a pole in a straight line, and around it in circles', () => {
    const over = (theta: number, s: number, out: Place): void => {
      // e_y × x on the sphere: a rotation whose streams pass the poles.
      const [x, , z] = SPHERE.point([theta, s]);
      const t = SPHERE.within(theta, s);
      const sign = SPHERE.radius(s) < 0 ? -1 : 1;
      const { out: o, up } = SPHERE.skin(t[1]);
      out[0] = sign * -z * Math.sin(t[0]);
      out[1] = sign * (-up * z * Math.cos(t[0]) - x * o);
    };
    for (const y of [0, 0.05, 0.3]) {
      let place = SPHERE.onto([0.5, y, Math.sqrt(1 - 0.25 - y * y)]);
      const next: Place = [0, 0];
      let highest = -1;
      for (let k = 0; k < 400; k++) {
        SPHERE.carry(...place, over, 0.02, next);
        place = [...next];
        const at = SPHERE.point(place);
        expect(at[1]).toBeCloseTo(y, 1.5); // it stays on its circle
        highest = Math.max(highest, at[2]);
      }
      expect(highest).toBeGreaterThan(Math.sqrt(1 - y * y) - 0.01);
      // Angular velocity 1: after a time of 8 it is where the rotation by 8 leads.
      const from = Math.atan2(0.5, Math.sqrt(0.75 - y * y));
      const [x, , z] = SPHERE.point(place);
      expect(nearest(0, Math.atan2(x, z) - from - 8, TURN)).toBeCloseTo(0, 1);
    }
    const around = (theta: number, s: number, out: Place): void => {
      [out[0], out[1]] = [SPHERE.radius(s), 0];
    };
    let ring: Place = [1, 0.2];
    const next: Place = [0, 0];
    for (let k = 0; k < 500; k++) {
      SPHERE.carry(...ring, around, 0.02, next);
      ring = [...next];
    }
    expect(ring[1]).toBeCloseTo(0.2, 2);
    expect(nearest(0, ring[0] - 11, TURN)).toBeCloseTo(0, 1);
  });

  it('a brush has its edge at one distance through space, over a pole too', () => {
    for (const [at, radius] of [[[0.4, 0.3], 0.5], [[0, POINTED.length], 0.4], [[2, 2], 1.2]] as [Place, number][]) {
      for (const edge of POINTED.edge(at, radius, 24)) expect(POINTED.apart(at, edge)).toBeCloseTo(radius, 1.5);
    }
  });

  it('a stroke over a pole has no gaps, and stays on the cell', () => {
    const sent: Place[][] = [];
    const stroke = new Stroke((points) => sent.push(points), 0.25, POINTED, 0);
    const end = POINTED.length;
    stroke.add([1, end - 0.4], 0);
    stroke.add([1 + Math.PI, end - 0.4], 200);
    stroke.end();
    const points = sent.flat();
    // Closer than the brush is wide: discs of it overlap.
    for (let k = 1; k < points.length; k++) expect(POINTED.apart(points[k - 1], points[k])).toBeLessThan(0.2);
    for (const [theta, s] of points) expect(theta >= 0 && theta < TURN && s >= 0 && s <= end).toBe(true);
    expect(points.some(([, s]) => s > end - 0.15)).toBe(true);
  });
});

describe('the view of a closed cell', () => {
  it('finds the place under the pointer, at the poles as well', () => {
    for (const surface of [SPHERE, POINTED]) {
      const view = new View();
      Object.assign(view, { width: 400, height: 500, surface, turn: 1, tilt: 0 });
      const [theta, s] = view.pick(200, 250)!;
      expect(theta).toBeCloseTo(1);
      expect(s).toBeCloseTo(surface.length / 2, 2);
      expect(view.pick(1, 1)).toBeNull();
      view.tilt = 1.5;
      view.hold();
      expect(view.pick(200, 250)![1]).toBeGreaterThan(surface.length - 0.3);
      view.tilt = -1.5;
      expect(view.pick(200, 250)![1]).toBeLessThan(0.3);
    }
  });

  it('agrees with where a place appears', () => {
    const view = new View();
    Object.assign(view, { width: 400, height: 500, surface: POINTED, turn: 2, tilt: 0.6 });
    for (const place of [[2.3, 3.5], [1.2, 2.5], [2, POINTED.length - 0.3]] as Place[]) {
      const [x, y, z] = POINTED.point(place);
      const ahead = x * Math.cos(2) + y * Math.sin(2);
      const right = y * Math.cos(2) - x * Math.sin(2);
      const up = z * Math.cos(0.6) - ahead * Math.sin(0.6);
      const [theta, s] = view.pick(200 + right * view.scale, 250 - up * view.scale)!;
      expect(theta).toBeCloseTo(place[0], 1);
      expect(s).toBeCloseTo(place[1], 1);
    }
  });

  it('fits the cell at every tilt, and turns to both poles', () => {
    const view = new View();
    Object.assign(view, { width: 400, height: 300, surface: POINTED });
    for (const tilt of [0, 0.7, 1.5]) {
      view.tilt = tilt;
      expect(view.scale * POINTED.half * Math.cos(tilt)).toBeLessThan(150);
      expect(view.scale).toBeLessThan(200);
    }
    view.turnBy(0, 5000);
    expect(view.tilt).toBeGreaterThan(1.4);
    view.surface = new CylinderSurface(5);
    expect(view.tilt).toBeLessThan(0.5);
  });
});

describe('what moves on a closed cell', () => {
  const fields = new Fields();
  fields.take(pictured((x, y, z) => [z, 0, -x]), SPHERE, 0);
  fields.blend(1);

  it('particles cover it evenly, and their trails have no jumps over the poles', () => {
    const particles = new Particles(false, 900, seeded());
    particles.scatter(SPHERE);
    const high = Array.from({ length: 900 }, (_, n) => SPHERE.point([particles.data[4 * n], particles.data[4 * n + 1]])[2]);
    // Areas between heights on a sphere are in proportion to these.
    for (const level of [-0.8, -0.4, 0, 0.4, 0.8]) expect(Math.abs(high.filter((z) => z < level).length / 900 - (1 + level) / 2)).toBeLessThan(0.06);
    for (let k = 0; k < 200; k++) particles.step(fields, 0.03);
    for (let n = 0; n < 900; n++) {
      for (let k = 1; k < TRAIL; k++) {
        const [a, b] = [4 * (900 * (k - 1) + n), 4 * (900 * k + n)];
        const [p, q] = [a, b].map((at): Place => [particles.data[at], particles.data[at + 1]]);
        expect(SPHERE.apart(p, q)).toBeLessThan(0.12);
      }
    }
  });

  it('streamlines follow the flow over the poles, and none is laid twice', () => {
    const lines = new Streamlines();
    lines.lay(fields, 0.3);
    expect(lines.count).toBeGreaterThan(40);
    const middles = Array.from({ length: lines.count }, (_, n) => {
      const at = 2 * (POINTS * n + (POINTS - 1) / 2);
      return SPHERE.within(lines.points[at], lines.points[at + 1]);
    });
    let near = 0;
    middles.forEach((one, k) => middles.slice(k + 1).forEach((other) => (near += SPHERE.apart(one, other) < 0.05 ? 1 : 0)));
    expect(near).toBeLessThan(4);
    for (let n = 0; n < lines.count; n++) {
      const heights = [0, POINTS - 1].map((k) => SPHERE.point([lines.points[2 * (POINTS * n + k)], lines.points[2 * (POINTS * n + k) + 1]])[1]);
      expect(heights[0]).toBeCloseTo(heights[1], 1); // circles about the y axis
    }
  });
});

describe('zones of a closed cell', () => {
  it('run between streams along the body, and end before the poles, where streams turn over', () => {
    const frame = pictured((x, y, z) => [z / 2.5, 0, -2.5 * x], POINTED);
    const rows = 2 * N;
    const found = new Contrast(N, rows, POINTED).of(doubled(frame.P_z, N, N + 1, -1));
    // P_s is 0 where x is 0, at theta = π/2.
    const zone = (j: number): number => found[(N / 4) * rows + j];
    expect(zone(N / 2)).toBeGreaterThan(0.15);
    expect(zone(0)).toBe(0);
    expect(zone(N)).toBe(0);
  });
});
