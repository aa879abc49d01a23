// Files that the server makes: it reports their progress, and stops when the page gives up.

import { say } from '../words/say';

/** The progress of a file: the share that is done, 0 to 1, or null while that is unknown. */
export interface Far {
  share: number | null;
  doing: string;
}

/** Milliseconds without a message of the server, which sends two per second. */
export const STALLED = 10_000;

/** Read lines of JSON with the progress of a file, and then the file. Throws an error that says why there is none. */
export async function made(answer: Response, tell: (far: Far) => void): Promise<Blob> {
  const reader = answer.body!.getReader();
  let held: Uint8Array<ArrayBuffer> = new Uint8Array(0);
  const more = async (): Promise<boolean> => {
    const { done, value } = await soon(reader.read());
    if (value) {
      const joined = new Uint8Array(held.length + value.length);
      joined.set(held);
      joined.set(value, held.length);
      held = joined;
    }
    return !done;
  };
  try {
    for (;;) {
      const end = held.indexOf(10);
      if (end < 0) {
        if (!(await more())) throw new Error(say('files.lost'));
        continue;
      }
      const words = JSON.parse(new TextDecoder().decode(held.subarray(0, end))) as Partial<Far> & { bytes?: number; sentence?: string };
      held = held.slice(end + 1);
      if (words.sentence !== undefined) throw new Error(words.sentence);
      if (words.bytes === undefined) tell({ share: words.share ?? null, doing: words.doing ?? '' });
      else return await whole(words.bytes);
    }
  } finally {
    void reader.cancel().catch(() => undefined);
  }

  async function whole(size: number): Promise<Blob> {
    const parts: Uint8Array<ArrayBuffer>[] = [held];
    let got = held.length;
    while (got < size) {
      tell({ share: 1, doing: say('files.fetching', { percent: Math.floor((100 * got) / size) }) });
      held = new Uint8Array(0);
      if (!(await more())) throw new Error(say('files.lost'));
      parts.push(held);
      got += held.length;
    }
    return new Blob(parts);
  }
}

/** The result of a read, or an error if nothing arrives for too long. */
function soon<T>(reading: Promise<T>): Promise<T> {
  let timer: ReturnType<typeof setTimeout>;
  const late = new Promise<never>((_, fail) => {
    timer = setTimeout(() => fail(new Error(say('files.stalled'))), STALLED);
  });
  return Promise.race([reading, late]).finally(() => clearTimeout(timer));
}
