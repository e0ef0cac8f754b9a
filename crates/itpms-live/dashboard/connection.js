// The stream from the monitor: opened again whenever it breaks or falls silent, with growing pauses, and from where it broke.

const SILENCE_MS = 4000;
const PAUSES_MS = [500, 1000, 2000, 4000, 8000];

// Calls `on(name, data)` for every event and `changed(connection)` when it is opened or lost.
export class Connection {
  constructor(address, on, changed) {
    Object.assign(this, { address, on, changed, open: false, lost_ms: Date.now(), retry_ms: null, id: "", tries: 0 });
    // After sleep or a change of network nobody wants to wait for a pause to pass.
    addEventListener("online", () => this.now());
    document.addEventListener("visibilitychange", () => document.hidden || this.now());
    setInterval(() => this.listen(), 1000);
    this.run();
  }
  // Tries again at once, unless the stream is open.
  now() {
    if (!this.open && this.wake) this.wake();
  }
  // Signs of life come every second: silence is a broken connection that nobody has told us of.
  listen() {
    if (this.open && Date.now() - this.heard_ms > SILENCE_MS) this.abort?.abort();
  }
  async run() {
    for (;;) {
      try {
        await this.read();
      } catch {
        // Whatever it was, the remedy is the same.
      }
      if (this.open) {
        this.open = false;
        this.lost_ms = Date.now();
      }
      const pause = PAUSES_MS[Math.min(this.tries++, PAUSES_MS.length - 1)] * (0.8 + 0.4 * Math.random());
      this.retry_ms = Date.now() + pause;
      this.changed(this);
      await new Promise((resolve) => {
        this.wake = resolve;
        setTimeout(resolve, pause);
      });
      this.wake = null;
    }
  }
  async read() {
    this.abort = new AbortController();
    const opening = setTimeout(() => this.abort.abort(), SILENCE_MS);
    const headers = this.id ? { "Last-Event-ID": this.id } : {};
    const response = await fetch(this.address, { headers, cache: "no-store", signal: this.abort.signal }).finally(() => clearTimeout(opening));
    if (!response.ok || !response.body) throw new Error("status " + response.status);
    this.heard_ms = Date.now();
    this.open = true;
    this.retry_ms = null;
    this.changed(this);
    const reader = response.body.pipeThrough(new TextDecoderStream()).getReader();
    let text = "";
    for (;;) {
      const { value, done } = await reader.read();
      if (done) return;
      this.heard_ms = Date.now();
      text += value;
      let end;
      while ((end = text.indexOf("\n\n")) >= 0) {
        this.take(text.slice(0, end));
        text = text.slice(end + 2);
      }
    }
  }
  take(event) {
    let name = "message", data = "";
    for (const line of event.split("\n")) {
      if (line.startsWith("id: ")) this.id = line.slice(4);
      else if (line.startsWith("event: ")) name = line.slice(7);
      else if (line.startsWith("data: ")) data += line.slice(6);
    }
    if (!data) return;
    this.tries = 0;
    this.on(name, JSON.parse(data));
  }
}
