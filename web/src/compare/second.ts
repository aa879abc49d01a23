import type { Socket } from '../connection';
import { h } from '../panels/dom';
import { makeRoom, showFrame, type Shown } from '../panels/arrivals';
import { Hub } from '../panels/hub';
import { isDark, keptPalette } from '../panels/dress';
import { Unseen } from '../panels/seen';
import { Waits } from '../panels/waits';
import type { About, Ask, Frame, Said } from '../protocol';
import { Scene, type Tool } from '../scene/scene';
import { Session } from '../session';

export interface Heard {
  cell(said: Extract<Said, { type: 'cell' }>): void;
  frame(frame: Frame): void;
  refused(sentence: string): void;
  lost(sentence: string): void;
}

/** The picture of the second cell, which stays when the comparison ends, and its session, which does not. */
export class Second implements Shown {
  readonly cylinder = h('div', { id: 'second-cylinder', class: 'second' });
  readonly map = h('div', { id: 'second-map', class: 'second' });
  readonly hub: Hub;
  readonly scene: Scene;
  readonly waits: Waits;
  readonly unseen: Unseen;
  private session: Session | null = null;

  constructor(private readonly root: HTMLElement, about: About, private readonly heard: Heard, toast: (sentence: string) => void) {
    this.hub = new Hub(about, (ask) => this.session?.ask(ask), toast);
    this.waits = new Waits(this.cylinder, () => []);
    this.unseen = new Unseen((frame) => this.hub.ask({ do: 'seen', frame }));
    this.root.append(this.cylinder, this.map);
    this.scene = new Scene({ cylinder: this.cylinder, map: this.map, palette: keptPalette(about.palettes), dark: isDark(), notice: toast });
    this.cylinder.append(this.waits.over);
    this.scene.onDrawn = (frame) => this.unseen.drawn(frame);
  }

  get open(): boolean {
    return this.session?.isOpen ?? false;
  }

  /** Begin a session with this cell, or another cell in the session that there is. */
  begin(link: string, make: (() => Socket) | undefined): void {
    if (this.session) {
      this.hub.ask({ do: 'begin', link });
      return;
    }
    this.hub.cell = this.hub.frame = null;
    this.session = new Session({
      hub: this.hub,
      waits: this.waits,
      said: (said) => this.hear(said),
      frame: (frame) => {
        showFrame(frame, this);
        this.heard.frame(frame);
      },
      inside: () => undefined,
      lost: (sentence) => {
        this.unseen.forget();
        this.heard.lost(sentence);
      },
      first: () => ({ do: 'begin', link }),
    }, make);
    this.session.open();
  }

  ask(ask: Ask): void {
    this.hub.ask(ask);
  }

  setTool(tool: Tool, radius: number): void {
    this.scene.setTool(tool, radius);
  }

  repaint(): void {
    this.scene.setDark(isDark());
    this.scene.setPalette(keptPalette(this.hub.about.palettes));
  }

  moveToBrowser(): void {
    this.session?.moveToBrowser();
  }

  end(): void {
    this.session?.end();
    this.session = null;
    this.scene.playing = false;
    this.unseen.forget();
  }

  private hear(said: Said): void {
    if (said.type === 'cell') {
      makeRoom(said, this);
      this.scene.hurry();
      this.hub.emit('cell', said);
      this.heard.cell(said);
    } else if (said.type === 'refused') this.heard.refused(said.sentence);
  }
}
