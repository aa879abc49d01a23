import type { Preset } from '../protocol';
import type { Tool } from '../scene/scene';
import type { Hub } from './hub';

export interface Stage {
  hub: Hub;
  choose(tool: Tool): void;
}

export interface Step {
  /** Selectors of the elements that the text describes. Its title and text are `tour.1`, `tour.1-text` and so on. */
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
    marks: ['#cylinder'],
    act: (stage) => {
      begin(stage);
      stage.choose('turn');
      stage.hub.ask({ do: 'pause' });
    },
  },
  {
    marks: ['#map', '[data-name="alpha_p"]'],
    act: ({ hub }) => {
      hub.ask({ do: 'speed', value: Math.min(1.5, hub.about.limits.fastest) });
      hub.ask({ do: 'play' });
    },
  },
  {
    marks: ['#cylinder', '[data-name="alpha_u"]', '#now'],
    act: ({ hub }) => {
      hub.ask({ do: 'speed', value: Math.min(8, hub.about.limits.fastest) });
      hub.ask({ do: 'play' });
    },
  },
  {
    marks: ['#map'],
    act: ({ hub }) => hub.ask({ do: 'play' }),
  },
  {
    marks: ['#panel-hand', '#cylinder'],
    act: (stage) => {
      stage.choose('wound');
      stage.hub.ask({ do: 'play' });
    },
  },
  {
    marks: ['#panel-diagram', '#panel-presets'],
    act: (stage) => stage.choose('turn'),
  },
];
