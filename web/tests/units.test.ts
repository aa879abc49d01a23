import { describe, expect, it } from 'vitest';
import { scalesIn, Units } from '../src/panels/units';
import { charted, pace, seen } from '../src/panels/words';
import type { Regime } from '../src/protocol';

const chara = new Units({ radius_um: 500, speed_um_s: 100 });
const pure = new Units(null);

describe('numbers in units', () => {
  it('are those of the package', () => {
    // cyclosis.Scales(500, 100): a unit of time is 5 s.
    expect(chara.second).toBe(5);
    expect([chara.lasting(1), chara.lasting(23.9), chara.lasting(24), chara.lasting(1440), chara.lasting(40000)]).toEqual(['5 s', '120 s', '2 min', '2 h', '2.31 d']);
    expect([chara.reaching(0.4), chara.reaching(5)]).toEqual(['200 µm', '2.5 mm']);
    expect(chara.speed).toEqual({ factor: 100, name: 'µm/s' });
    expect([chara.parameter('alpha_p', 1), chara.parameter('alpha_u', 1), chara.parameter('d_s', 0.025), chara.parameter('mu', 1)]).toEqual(['0.2 /s', '0.002 /µm', '1250 µm²/s', '']);
  });

  it('are dimensionless without scales', () => {
    expect([pure.lasting(8.31, 2), pure.reaching(0.4), pure.clock(12.34), pure.parameter('alpha_p', 1)]).toEqual(['8.3 R/U', '0.4 R', 't = 12.3', '']);
    expect(pure.bar(3)).toBeNull();
    expect([chara.clock(12.34), chara.clock(60)]).toEqual(['61.7 s', '5.0 min']);
  });

  it('have a bar of a round length', () => {
    for (const [about, name] of [[1.9, '500 µm'], [2, '1 mm'], [0.05, '20 µm'], [0.4, '200 µm']] as const) {
      const bar = chara.bar(about)!;
      expect(bar.name).toBe(name);
      expect(bar.length).toBeLessThanOrEqual(about * (1 + 1e-9));
      expect(bar.length).toBeGreaterThan(about / 2.51);
    }
    expect(chara.bar(0)).toBeNull();
  });

  it('stand in the sentences too', () => {
    const regime: Regime = { name: 'travelling', reason: '', zones: [], widths: [], order: 1, around: 0, boundaries: [2, 2], drift: [0.01, 0], mean: [0, 0], pace: -0.1 };
    expect(pace(regime, chara)).toContain('35 s');
    expect(seen(regime, [], chara)).toContain('52 min');
    expect(charted('order', true, chara).at(-1)).toContain('is 5 s');
  });

  it('need both scales', () => {
    expect([scalesIn({}), scalesIn({ radius_um: 1 }), scalesIn(undefined)]).toEqual([null, null, null]);
    expect(scalesIn({ radius_um: 1, speed_um_s: 2 })).toEqual({ radius_um: 1, speed_um_s: 2 });
  });
});
