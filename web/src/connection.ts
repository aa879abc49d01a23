import { readFrame, type Ask, type Frame, type Said } from './protocol';

export interface Listener {
  open(): void;
  said(said: Said): void;
  frame(frame: Frame): void;
  lost(): void;
}

/** The address of the cell beside this page. */
export function cellAddress(location: { href: string }): string {
  const address = new URL('cell', location.href);
  address.protocol = address.protocol === 'https:' ? 'wss:' : 'ws:';
  address.hash = '';
  address.search = '';
  return address.href;
}

/** One WebSocket at a time; what is asked while none is open is dropped, since no cell would hear it. */
export class Connection {
  private socket: WebSocket | null = null;

  constructor(private readonly listener: Listener) {}

  get isOpen(): boolean {
    return this.socket?.readyState === WebSocket.OPEN;
  }

  open(): void {
    const before = this.socket;
    this.socket = null;
    before?.close();
    const socket = new WebSocket(cellAddress(location));
    socket.binaryType = 'arraybuffer';
    this.socket = socket;
    const current = (): boolean => this.socket === socket;
    socket.onopen = () => current() && this.listener.open();
    socket.onclose = () => current() && this.listener.lost();
    socket.onmessage = ({ data }: MessageEvent<ArrayBuffer | string>) => {
      if (!current()) return;
      if (typeof data === 'string') this.listener.said(JSON.parse(data) as Said);
      else this.listener.frame(readFrame(data));
    };
  }

  ask(message: Ask): void {
    if (this.isOpen) this.socket!.send(JSON.stringify(message));
  }
}
