import { parted } from '../compare/parted';
import { firstPreset } from '../panels/story';
import type { About, Ask } from '../protocol';

/** The request that begins the first cell: that of the address, or the first preset. */
export function firstCell({ presets, scales }: About, hash: string): Ask {
  const { link } = parted(hash);
  const preset = firstPreset(presets)?.name;
  const ask: Ask = link ? { do: 'begin', link } : preset ? { do: 'begin', preset } : { do: 'begin', setup: {} };
  return { scales: scales ?? undefined, ...ask };
}
