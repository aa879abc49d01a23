import type { Frame, Said } from '../protocol';
import type { Scene } from '../scene/scene';
import type { Hub } from './hub';
import type { Unseen } from './seen';
import type { Waits } from './waits';

/** The parts of the page that show one cell. */
export interface Shown {
  hub: Hub;
  waits: Waits;
  scene: Scene;
  unseen: Unseen;
}

/** Make room for the picture of another cell, if what is said of a cell begins one. */
export function makeRoom(said: Extract<Said, { type: 'cell' }>, { hub, waits, scene, unseen }: Shown): void {
  // The message that began another cell may have been lost with a connection.
  said.fresh ||= said.begun !== hub.cell?.begun;
  if (!said.fresh) return;
  waits.blank(true);
  scene.clear(said.outline);
  unseen.dropped();
  hub.frame = null;
}

/** Show a picture that has arrived. */
export function showFrame(frame: Frame, { hub, waits, scene, unseen }: Shown): void {
  waits.blank(false);
  unseen.came(frame.frame);
  scene.show(frame);
  hub.emit('frame', frame);
}
