import type { Preset } from '../protocol';
import type { Tool } from '../scene/scene';
import type { Hub } from './hub';

export interface Stage {
  hub: Hub;
  choose(tool: Tool): void;
}

export interface Step {
  title: string;
  text: string;
  /** Selectors of what the text speaks of. */
  marks: string[];
  act(stage: Stage): void;
}

/** The cell of the emergence of cyclosis, whatever it is called among the presets. */
export function firstPreset(presets: Preset[]): Preset | undefined {
  return presets.find((p) => /figure.?4/i.test(p.name)) ?? presets.find((p) => p.group === 'figures') ?? presets[0];
}

function begin({ hub }: Stage): void {
  const preset = firstPreset(hub.about.presets);
  hub.ask(preset ? { do: 'begin', preset: preset.name } : { do: 'begin', setup: {} });
}

/** The paper's story, in the order in which it can be seen. */
export const STORY: Step[] = [
  {
    title: 'A cell, and what streams in it',
    text: 'This is the skin of one giant cell, a cylinder closed on itself. Actin filaments lie all over it. Where they point up it is purple, where they point down green, and nearly black where they disagree. Motors walk along them and drag the fluid. The cell begins in disorder: each spot points anywhere, and nothing streams.',
    marks: ['#cylinder'],
    act: (stage) => {
      begin(stage);
      stage.choose('turn');
      stage.hub.ask({ do: 'pause' });
    },
  },
  {
    title: 'Neighbours come to agree',
    text: 'Filaments bundle: side by side they turn the same way, at the rate α_p. The cell is running slowly now. Watch patches of one colour appear and grow. Each patch agrees with itself, and not yet with the next.',
    marks: ['#map', '[data-name="alpha_p"]'],
    act: ({ hub }) => {
      hub.ask({ do: 'speed', value: Math.min(1.5, hub.about.limits.fastest) });
      hub.ask({ do: 'play' });
    },
  },
  {
    title: 'The flow lines them up',
    text: 'Fluid cannot pile up, so what streams up here must come down there. The flow turns the filaments along itself, at the rate α_u, and they drive it on: a patch at one end learns of a patch at the other. Two stripes emerge, one up and one down. That is cyclosis. It takes about 50 time units.',
    marks: ['#cylinder', '[data-name="alpha_u"]', '#now'],
    act: ({ hub }) => {
      hub.ask({ do: 'speed', value: Math.min(8, hub.about.limits.fastest) });
      hub.ask({ do: 'play' });
    },
  },
  {
    title: 'The indifferent zones',
    text: 'Between the stripes run two lines where nothing streams: the indifferent zones, known from Chara for two centuries. Nobody drew them. They straighten on their own, slowly: see how the waves of the white lines fade.',
    marks: ['#map'],
    act: ({ hub }) => hub.ask({ do: 'play' }),
  },
  {
    title: 'Hurt it',
    text: 'The wound tool is in your hand: draw across the cell, and see the stripes close over it. Now press Cytochalasin, which stops bundling. Standing stripes grow a little weaker, but the flow holds them. Break the cell under the drug (Fragment, with a wide brush, all over) and it stays broken, until you press Wash out and it organises itself again.',
    marks: ['#panel-hand', '#cylinder'],
    act: (stage) => {
      stage.choose('wound');
      stage.hub.ask({ do: 'play' });
    },
  },
  {
    title: 'Other fates',
    text: 'Every place in this diagram is a cell with other α_p and α_u; the colour says how often it ended in cyclosis. With little flow alignment many cells stream one way only and stall; with little bundling nothing orders. Click anywhere to send this cell there, or choose a preset and try an idea of your own.',
    marks: ['#panel-diagram', '#panel-presets'],
    act: (stage) => stage.choose('turn'),
  },
];
