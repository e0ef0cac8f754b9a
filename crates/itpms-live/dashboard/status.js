// Whether what is shown is now. Says so in words, and greys what is not.

import { plain, put, span, timeOfDay } from "./words.js";

export class Status {
  constructor() {
    // When the newest row came, by the server on this machine's clock; NaN: never.
    this.data_ms = NaN;
    this.health = null;
    this.banner = document.getElementById("status");
    this.word = document.getElementById("status-word");
    this.text = document.getElementById("status-text");
    this.retry = document.getElementById("retry");
    this.spoken = document.getElementById("spoken-status");
  }
  // The server's clock may be wrong: only differences of it are used.
  hello(hello) {
    this.health = hello.health;
    this.offset_ms = Date.now() - hello.unix_s * 1000;
  }
  history(history) {
    this.date(history.fine.time_s.at(-1), history.fine.unix_s.at(-1));
  }
  // Before the first row there is no time of the data's own, and `unix_s` is the monitor's start.
  date(time_s, unix_s) {
    const ms = time_s == null || unix_s == null ? NaN : unix_s * 1000 + this.offset_ms;
    if (Number.isNaN(ms) || ms === this.data_ms) return false;
    this.data_ms = ms;
    return true;
  }
  snapshot(snapshot) {
    // What was overdue has come.
    if (this.date(snapshot.time_s, snapshot.unix_s)) this.health = null;
    this.source = snapshot.source;
  }
  beat(beat) {
    this.health = beat.health;
  }
  // `live`, `waiting`, `stale`, `ended` or `gone`.
  judge(connection) {
    if (!connection.open) return "gone";
    const state = this.source?.state;
    if (Number.isNaN(this.data_ms)) return "waiting";
    if (state === "ended") return "ended";
    // The server knows how often news is due, and says every second whether it is overdue.
    return state !== "live" || this.health?.status === "stale" ? "stale" : "live";
  }
  since() {
    return Number.isNaN(this.data_ms) ? "No data yet" : `No data since ${timeOfDay(this.data_ms)}`;
  }
  // Headline while there is nothing new.
  headline(state) {
    if (state === "waiting") return "Waiting for the first data";
    if (state === "ended") return `The data ended at ${timeOfDay(this.data_ms)}`;
    return this.since();
  }
  draw(connection) {
    const state = this.judge(connection);
    const name = this.source ? plain(this.source.name) : "the source";
    const age = span((Date.now() - this.data_ms) / 1000);
    const words = {
      live: ["Live", `Data from ${name} is coming in.`],
      waiting: ["Waiting", `Connected to the monitor; nothing has come from ${name} yet.`],
      stale: ["Stale", `${this.since()} (${age} ago). Connected to the monitor, but nothing comes from ${name}. All values are old.`],
      ended: ["Ended", `${name} is at its end. All values are the last ones, from ${timeOfDay(this.data_ms)} (${age} ago).`],
      gone: ["No connection", `${this.since()}. The monitor cannot be reached; ${this.pause(connection)}.${Number.isNaN(this.data_ms) ? "" : " All values are old."}`],
    }[state];
    document.documentElement.dataset.freshness = state;
    this.banner.dataset.state = state;
    put(this.word, words[0]);
    put(this.text, words[1]);
    this.retry.hidden = state !== "gone";
    // Spoken once when it changes, without the seconds that run.
    if (state !== this.said) {
      const first = this.said === undefined;
      this.said = state;
      if (!first || state !== "gone") {
        put(this.spoken, state === "live" ? "Data is coming in." : state === "waiting" ? "Waiting for data." : `${words[0]}: ${state === "ended" ? this.headline(state) : this.since()}.`);
      }
    }
    return state;
  }
  pause(connection) {
    if (connection.retry_ms == null) return "trying";
    const s = Math.ceil((connection.retry_ms - Date.now()) / 1000);
    return s > 0 ? `trying again in ${s} s` : "trying again";
  }
}
