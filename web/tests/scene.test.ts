import { describe, expect, it } from 'vitest';
import { type Frame, type Palette } from '../src/protocol';
import { Stroke } from '../src/scene/brush';
import { Pieces, zeroLines } from '../src/scene/contours';
import { Contrast, FAINT, GRAIN, PLAIN, REACH, weight } from '../src/scene/contrast';
import { Fields } from '../src/scene/fields';
import { Enlarger, flowAt } from '../src/scene/interpolate';
import { golden } from './golden';
import { colourAt, directionOf, DirectionTable, paletteTable } from '../src/scene/palette';
import { Particles, TRAIL } from '../src/scene/particles';
import { POINTS, Streamlines } from '../src/scene/streamlines';
import { CylinderSurface, nearest, wrap, type Place } from '../src/scene/surface';
import { View } from '../src/scene/view';
import shared from './contrast.json';

const TURN = 2 * Math.PI;
const CELL = new CylinderSurface(5);

function frame(
  number: number,
  P_z: (theta: number, z: number) => number,
  u: (theta: number, z: number) => [number, number],
  n = 16,
  length = 5,
): Frame {
  const fields = [0, 1, 2, 3].map(() => new Float32Array(n * n));
  let peak = 0;
  for (let i = 0; i < n; i++) {
    for (let j = 0; j < n; j++) {
      const [theta, z] = [(TURN * i) / n, (length * j) / n];
      const [a, b] = u(theta, z);
      peak = Math.max(peak, Math.hypot(a, b));
      [0, P_z(theta, z), a, b].forEach((value, k) => (fields[k][i * n + j] = value));
    }
  }
  const [P_theta, P, u_theta, u_z] = fields;
  const empty = new Float32Array(n);
  return {
    ...{ t: 0, frame: number, n_theta: n, n_z: n, length, peak_speed: peak, regime: null },
    ...{ P_theta, P_z: P, u_theta, u_z, profile_P: empty, profile_u: empty, records: new Float64Array(0) },
  };
}

const seeded = (): (() => number) => {
  let state = 1;
  return () => (state = (state * 16807) % 2147483647) / 2147483647;
};

describe('palette', () => {
  const palette: Palette = {
    name: 'p',
    title: 'p',
    stops: [
      [-1, '#00ff00'],
      [0, '#000000'],
      [1, '#8000ff'],
    ],
    zone: '#ffffff',
    wheel: null,
  };

  it('is linear between stops and constant beyond', () => {
    expect(colourAt(palette.stops, -1)).toEqual([0, 255, 0]);
    expect(colourAt(palette.stops, 0.5)).toEqual([64, 0, 128]);
    expect(colourAt(palette.stops, 3)).toEqual([128, 0, 255]);
    expect(colourAt(palette.stops, -3)).toEqual([0, 255, 0]);
  });

  it('makes a table from -1 to 1', () => {
    const table = paletteTable(palette, 101);
    expect([...table.slice(0, 4)]).toEqual([0, 255, 0, 255]);
    expect([...table.slice(200, 204)]).toEqual([0, 0, 0, 255]);
    expect([...table.slice(400)]).toEqual([128, 0, 255, 255]);
  });
});

describe('colours of directions', () => {
  const { palettes, directions } = golden<{ palettes: Palette[]; directions: number[][] }>('colours.json');
  const { wheel } = palettes.find(({ name }) => name === 'direction')!;
  const table = new DirectionTable(wheel!);

  it.each([0, 1, 2])('are those of the figures, part %i', (part) => {
    for (const [around, along, ...colour] of directions) {
      expect(directionOf(wheel!, around!, along!)[part]).toBeCloseTo(colour[part]!, 5);
      const pixel = new Uint8Array(Uint32Array.of(table.of(around!, along!)).buffer);
      expect(Math.abs(pixel[part]! / 255 - colour[part]!), `${around} ${along}`).toBeLessThan(0.02);
    }
  });

  it('go around without a seam', () => {
    for (const angle of [-Math.PI, 0, Math.PI / 2]) {
      const [one, other] = [-1e-6, 1e-6].map((off) => directionOf(wheel!, Math.cos(angle + off), Math.sin(angle + off)));
      one!.forEach((part, c) => expect(part).toBeCloseTo(other![c]!, 4));
    }
  });
});

describe('zero lines', () => {
  const field = (n: number, f: (x: number, y: number) => number): Float32Array =>
    Float32Array.from({ length: n * n }, (_, k) => f(k % n, Math.floor(k / n)));

  it('lie where a stripe changes sign, over the seam too', () => {
    const n = 32;
    const values = field(n, (x) => Math.cos((TURN * (x + 0.5)) / n));
    const out = new Pieces();
    zeroLines(values, n, n, field(n, () => 1), 0.1, out);
    expect(out.count).toBe(2 * n);
    for (let k = 0; k < out.count; k++) {
      const x = out.data[5 * k];
      expect(Math.min(Math.abs(x - 7.5), Math.abs(x - 23.5))).toBeLessThan(1e-5);
    }
    const seam = field(n, (x) => Math.sin((TURN * (x + 0.5)) / n));
    zeroLines(seam, n, n, field(n, () => 1), 0.1, out);
    const places = new Set(Array.from({ length: out.count }, (_, k) => out.data[5 * k].toFixed(3)));
    expect([...places].sort()).toEqual(['15.500', '31.500']);
  });

  it('close around a patch, with its circumference', () => {
    const n = 64;
    const out = new Pieces();
    zeroLines(field(n, (x, y) => 15 - Math.hypot(x - 32, y - 32)), n, n, field(n, () => 1), 0.1, out);
    const ends = new Map<string, number>();
    let around = 0;
    for (let k = 0; k < out.count; k++) {
      const [x0, y0, x1, y1] = out.data.slice(5 * k, 5 * k + 4);
      around += Math.hypot(x1 - x0, y1 - y0);
      for (const end of [`${x0.toFixed(3)} ${y0.toFixed(3)}`, `${x1.toFixed(3)} ${y1.toFixed(3)}`]) {
        ends.set(end, (ends.get(end) ?? 0) + 1);
      }
    }
    expect(around).toBeCloseTo(TURN * 15, 0);
    expect([...ends.values()].every((count) => count % 2 === 0)).toBe(true);
  });

  it('never join all four corners of a saddle, and leave out what is weak', () => {
    const out = new Pieces();
    const values = Float32Array.from([1, -1, -1, 1]);
    zeroLines(values, 2, 2, values.map(() => 1), 0.1, out);
    expect(out.count).toBe(8);
    zeroLines(values, 2, 2, values.map(() => 0.05), 0.1, out);
    expect(out.count).toBe(0);
  });

  it('hold more pieces than at first', () => {
    const n = 128;
    const out = new Pieces();
    zeroLines(field(n, (x, y) => ((x + y) % 2 ? -1 : 1)), n, n, field(n, () => 1), 0, out);
    expect(out.count).toBe(2 * n * n);
  });
});

describe('the contrast around a line', () => {
  it('is that of the Python package', () => {
    expect([REACH, GRAIN, FAINT, PLAIN]).toEqual([shared.reach, shared.grain, shared.faint, shared.plain]);
    expect(shared.cells.length).toBe(3);
    for (const { n_theta, n_z, length, P_z, contrast } of shared.cells) {
      const found = new Contrast(n_theta, n_z, new CylinderSurface(length)).of(Float32Array.from(P_z));
      found.forEach((value, p) => expect(Math.abs(value - contrast[p])).toBeLessThan(2e-6));
    }
  });

  it('shows a line between steady streams in full, though P vanishes on it, and none in disorder', () => {
    const [steady, disorder] = shared.cells;
    const lines = (cell: typeof steady): number[] => {
      const fields = new Fields();
      const seen = frame(0, () => 0, () => [0, 0], 2, cell.length);
      seen.n_theta = cell.n_theta;
      seen.n_z = cell.n_z;
      seen.P_z = Float32Array.from(cell.P_z);
      for (const name of ['P_theta', 'u_theta', 'u_z'] as const) seen[name] = new Float32Array(seen.P_z.length);
      fields.take(seen, CELL, 0);
      const [width, height] = [4 * cell.n_theta, 4 * cell.n_z];
      const enlarger = new Enlarger(cell.n_theta, cell.n_z, width, height);
      const [values, strength] = [new Float32Array(width * height), new Float32Array(width * height)];
      enlarger.enlarge(fields.order, 0, 1, values);
      enlarger.enlarge(fields.order, 1, 1, strength);
      const out = new Pieces();
      zeroLines(values, width, height, strength, FAINT, out);
      return Array.from({ length: out.count }, (_, n) => weight(out.data[5 * n + 4]));
    };
    expect(lines(steady)).toEqual(new Array(2 * 4 * steady.n_z).fill(1));
    expect(lines(disorder)).toEqual([]);
  });
});

describe('interpolation', () => {
  it('is exact at points, linear between, periodic', () => {
    const flow = Float32Array.from({ length: 2 * 4 * 4 }, (_, k) => k);
    const out: [number, number] = [0, 0];
    flowAt(flow, 4, 4, 8, TURN / 4, 4, out);
    expect(out).toEqual([12, 13]);
    flowAt(flow, 4, 4, 8, TURN / 8, 4, out);
    expect(out[0]).toBeCloseTo(8);
    flowAt(flow, 4, 4, 8, 1 + TURN, 3 - 8, out);
    const again: [number, number] = [0, 0];
    flowAt(flow, 4, 4, 8, 1, 3, again);
    expect(out[0]).toBeCloseTo(again[0]);
  });

  it('enlarges smoothly, z up, mixing before and now', () => {
    const fields = new Fields();
    const still = (): [number, number] => [0, 0];
    fields.take(frame(0, (theta, z) => Math.sin(theta) + 0.5 * Math.cos((TURN * z) / 5), still), CELL, 0);
    const enlarger = new Enlarger(16, 16, 64, 48);
    const out = new Float32Array(64 * 48);
    enlarger.enlarge(fields.order, 0, 1, out);
    for (let row = 0; row < 48; row++) {
      for (let k = 0; k < 64; k++) {
        const exact = Math.sin((TURN * (k + 0.5)) / 64) + 0.5 * Math.cos((TURN * (47.5 - row)) / 48);
        expect(Math.abs(out[row * 64 + k] - exact)).toBeLessThan(0.02);
      }
    }
    fields.take(frame(1, () => 0, still), CELL, 1000);
    enlarger.enlarge(fields.order, 0, 0.5, out);
    expect(out[0]).toBeCloseTo(0.5 * (Math.sin(TURN / 128) + 0.5), 1);
  });
});

describe('frames', () => {
  const up = (): [number, number] => [0, 1];
  const down = (): [number, number] => [0, -1];

  it('pass into each other without a jump', () => {
    const fields = new Fields();
    fields.take(frame(0, () => 1, up), CELL, 0);
    fields.blend(fields.mixing(0));
    expect(fields.flow[1]).toBe(1);
    fields.take(frame(1, () => -1, down), CELL, 1000);
    expect(fields.mixing(1000)).toBe(0);
    const half = 1000 + 0.5 * (60 + 0.3 * (1000 - 60));
    expect(fields.mixing(half)).toBeCloseTo(0.5);
    fields.blend(fields.mixing(half));
    expect(fields.flow[1]).toBeCloseTo(0);
    fields.take(frame(2, () => -1, down), CELL, half);
    fields.blend(fields.mixing(half));
    expect(fields.flow[1]).toBeCloseTo(0);
    expect(fields.mixing(half + 5000)).toBe(1);
  });

  it('of another grid begin at once', () => {
    const fields = new Fields();
    fields.take(frame(0, () => 1, up), CELL, 0);
    fields.take(frame(1, () => -1, down, 8), new CylinderSurface(8), 10);
    fields.blend(0);
    expect(fields.flow.length).toBe(128);
    expect(fields.flow[1]).toBe(-1);
  });
});

describe('particles', () => {
  const moved = (velocity: [number, number], seconds: number, largest = 0): number[][] => {
    const fields = new Fields();
    fields.take(frame(0, () => 1, () => velocity), CELL, 0);
    fields.blend(1);
    fields.largest = Math.max(fields.largest, largest);
    const particles = new Particles(false, 40, seeded());
    particles.scatter(CELL);
    const from = particles.data.slice(0, 160);
    for (let k = 0; k < 20; k++) particles.step(fields, seconds / 20);
    return Array.from({ length: 40 }, (_, n) => [
      nearest(0, particles.data[4 * n] - from[4 * n], TURN),
      nearest(0, particles.data[4 * n + 1] - from[4 * n + 1], 5),
      particles.data[4 * n],
      particles.data[4 * n + 1],
    ]);
  };

  it('move 0.6 radii a second at the peak, whatever its size, and wrap', () => {
    for (const size of [1, 1e-4]) {
      const steps = moved([0.6 * size, 0.8 * size], 0.5);
      // A few are renewed on the way.
      const kept = steps.filter(([dx, dz]) => Math.abs(dx - 0.18) < 1e-4 && Math.abs(dz - 0.24) < 1e-4);
      expect(kept.length).toBeGreaterThan(30);
      for (const [, , theta, z] of steps) {
        expect(theta >= 0 && theta <= TURN && z >= 0 && z <= 5).toBe(true);
      }
    }
  });

  it('rest where nothing flows, and slow down when a strong flow dies', () => {
    expect(moved([0, 0], 0.5).filter(([dx, dz]) => dx === 0 && dz === 0).length).toBeGreaterThan(30);
    const slowed = moved([0, 0.015], 0.5, 1).filter(([, dz]) => Math.abs(dz - 0.03) < 1e-4);
    expect(slowed.length).toBeGreaterThan(30);
  });

  it('have trails without jumps at the seams', () => {
    const fields = new Fields();
    fields.take(frame(0, () => 1, () => [1, 1]), CELL, 0);
    fields.blend(1);
    const particles = new Particles(false, 60, seeded());
    for (let k = 0; k < 400; k++) particles.step(fields, 0.03);
    for (let n = 0; n < 60; n++) {
      for (let k = 1; k < TRAIL; k++) {
        const [a, b] = [4 * (60 * (k - 1) + n), 4 * (60 * k + n)];
        expect(Math.abs(particles.data[a] - particles.data[b])).toBeLessThan(0.1);
        expect(Math.abs(particles.data[a + 1] - particles.data[b + 1])).toBeLessThan(0.1);
      }
    }
  });
});

describe('streamlines', () => {
  it('run downstream and keep apart', () => {
    const fields = new Fields();
    fields.take(frame(0, () => 1, (theta) => [0, Math.sin(theta)]), CELL, 0);
    fields.blend(1);
    const lines = new Streamlines();
    lines.lay(fields, 0.5);
    expect(lines.count).toBeGreaterThan(20);
    for (let n = 0; n < lines.count; n++) {
      const first = 2 * POINTS * n;
      const [theta, z, , next] = lines.points.slice(first, first + 4);
      expect(Math.sign(next - z)).toBe(Math.sign(Math.sin(theta)));
    }
    fields.take(frame(1, () => 1, () => [0, 0]), CELL, 0);
    lines.lay(fields, 0.5);
    expect(lines.count).toBe(0);
  });
});

describe('strokes', () => {
  it('are joined over the seam, sent in batches, and always end with a point', () => {
    const sent: Place[][] = [];
    const stroke = new Stroke((points) => sent.push(points), 0.25, CELL, 0);
    stroke.add([0.1, 4.9], 0);
    stroke.add([TURN - 0.1, 0.1], 40);
    expect(sent).toEqual([]);
    stroke.add([TURN - 0.3, 0.3], 160);
    expect(sent.length).toBe(1);
    stroke.end();
    expect(sent.length).toBe(2);
    expect(sent[1].length).toBe(1);
    const points = sent.flat();
    for (let k = 1; k < points.length; k++) {
      const dx = nearest(0, points[k][0] - points[k - 1][0], TURN);
      const dz = nearest(0, points[k][1] - points[k - 1][1], 5);
      expect(Math.hypot(dx, dz)).toBeLessThan(0.15);
    }
    for (const [theta, z] of points) expect(theta >= 0 && theta < TURN && z >= 0 && z < 5).toBe(true);
    expect(wrap(-1e-20, TURN)).toBe(0);
  });
});

describe('view', () => {
  it('finds the place under the pointer', () => {
    const view = new View();
    Object.assign(view, { width: 400, height: 500, surface: CELL, turn: 1, tilt: 0.3 });
    const [theta, z] = view.pick(200, 250)!;
    expect(theta).toBeCloseTo(1);
    // The near side of the middle of the cell lies above its axis's middle when looked at from above: z is larger.
    expect(z).toBeCloseTo(2.5 + Math.tan(0.3));
    expect(view.pick(1, 250)).toBeNull();
    expect(view.pick(200, 499)).toBeNull();
    const right = view.pick(220, 250)!;
    expect(right[0]).toBeGreaterThan(theta);
    view.turnBy(30, 0);
    expect(view.pick(230, 250)![0]).toBeCloseTo(1, 1);
  });

  it('fits long cells and zooms about the pointer', () => {
    const view = new View();
    Object.assign(view, { width: 400, height: 500, surface: new CylinderSurface(50) });
    expect(view.scale * 50 * Math.cos(view.tilt)).toBeLessThan(500);
    const before = view.pick(200, 150)![1];
    view.zoomBy(5, 150);
    // The front of the cylinder is nearer, which the axis does not see.
    expect(Math.abs(view.pick(200, 150)![1] - before)).toBeLessThan(0.3);
  });
});
