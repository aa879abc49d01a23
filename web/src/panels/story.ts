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
  /** Selectors of the elements that the text describes. */
  marks: string[];
  act(stage: Stage): void;
}

/** The preset in which cyclosis emerges, whatever its name. */
export function firstPreset(presets: Preset[]): Preset | undefined {
  return presets.find((p) => /figure.?4/i.test(p.name)) ?? presets.find((p) => p.group === 'figures') ?? presets[0];
}

function begin({ hub }: Stage): void {
  const preset = firstPreset(hub.about.presets);
  hub.ask(preset ? { do: 'begin', preset: preset.name } : { do: 'begin', setup: {} });
}

/** The paper's story, in the order in which it appears on the screen. */
export const STORY: Step[] = [
  {
    title: 'A cell, and what streams in it',
    text: 'This is the skin of one giant cell, a cylinder closed on itself, covered with actin filaments. It is purple where they point up, green where they point down, and nearly black where they disagree. Motors walk along the filaments and drag the fluid. The cell begins in disorder: filaments point in all directions, and nothing streams.',
    marks: ['#cylinder'],
    act: (stage) => {
      begin(stage);
      stage.choose('turn');
      stage.hub.ask({ do: 'pause' });
    },
  },
  {
    title: 'Neighbours agree',
    text: 'Filaments bundle: side by side they turn to point the same way, at the rate α_p. The cell is running slowly now. Watch patches of one colour appear and grow. Filaments agree within a patch, but not yet with those of the next.',
    marks: ['#map', '[data-name="alpha_p"]'],
    act: ({ hub }) => {
      hub.ask({ do: 'speed', value: Math.min(1.5, hub.about.limits.fastest) });
      hub.ask({ do: 'play' });
    },
  },
  {
    title: 'The flow lines them up',
    text: 'Fluid cannot pile up, so what streams up here must come down there. The flow aligns the filaments with itself, at the rate α_u, and they in turn drive the flow: this links patches at opposite ends of the cell. Two stripes emerge, one up and one down. That is cyclosis. It takes about 50 time units.',
    marks: ['#cylinder', '[data-name="alpha_u"]', '#now'],
    act: ({ hub }) => {
      hub.ask({ do: 'speed', value: Math.min(8, hub.about.limits.fastest) });
      hub.ask({ do: 'play' });
    },
  },
  {
    title: 'The indifferent zones',
    text: 'Between the stripes run two lines where nothing streams: the indifferent zones, known from Chara for two centuries. Nothing in the model puts them there. They straighten slowly on their own: see how the waves of the white lines fade.',
    marks: ['#map'],
    act: ({ hub }) => hub.ask({ do: 'play' }),
  },
  {
    title: 'Hurt it',
    text: 'The wound tool is in your hand: draw across the cell, and see the stripes close over the wound. Now press Cytochalasin, which stops bundling. Existing stripes become a little weaker, but the flow keeps them. Break up the whole cell under the drug (Fragment, with a wide brush) and it stays broken, until you press Wash out and it organises itself again.',
    marks: ['#panel-hand', '#cylinder'],
    act: (stage) => {
      stage.choose('wound');
      stage.hub.ask({ do: 'play' });
    },
  },
  {
    title: 'Other fates',
    text: 'Every point in this diagram is a cell with other values of α_p and α_u; the colour shows how often it ended in cyclosis. With little flow alignment many cells order in one direction only and stop streaming; with little bundling there is no order. Click anywhere to move this cell there, or choose a preset and try an idea of your own.',
    marks: ['#panel-diagram', '#panel-presets'],
    act: (stage) => stage.choose('turn'),
  },
];
