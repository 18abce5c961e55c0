// Asks the service. Where it wants a token, that is asked for once and kept as long as the tab is open.

import { asked } from "/pages/dialog.js";
import { element } from "/pages/element.js";

/// A refusal of the service in its own words (RFC 9457).
export class Refusal extends Error {
  constructor(status, document) {
    super(document.detail || document.title || `The service answered with ${status}.`);
    this.status = status;
    this.faults = document.errors ?? [];
  }
}

let asking = null;

/// Asks for a token, once for all who wait for it; false if there was none. Headers take visible ASCII only.
function askForToken(why) {
  if (asking) return asking;
  const token = element("input", { type: "password", autocomplete: "off", required: true, pattern: "\\s*[!-~]+\\s*", title: "Letters, digits and signs of ASCII, without blanks", className: "code", id: "token" });
  asking = asked([element("h2", {}, "A token, please"), element("p", {}, why), element("p", {}, element("label", { htmlFor: "token" }, "Token"), " ", token)], "Go on", "Without one").then((entered) => {
    asking = null;
    if (entered) sessionStorage.setItem("token", token.value.trim());
    dispatchEvent(new Event("tokenchange"));
    return entered;
  });
  return asking;
}

export function withToken(headers) {
  const token = sessionStorage.getItem("token");
  return token ? { ...headers, Authorization: `Bearer ${token}` } : headers;
}

async function refusalOf(reply) {
  return new Refusal(reply.status, await reply.json().catch(() => ({})));
}

/// There is no service, or its reply breaks off.
export const isAway = "The service cannot be reached; trying again.";
export class Unreached extends Error {
  constructor() {
    super("The service cannot be reached.");
  }
}
const reached = (asked) => asked.catch((error) => { throw error instanceof TypeError ? new Unreached() : error; });
const pause = (time) => new Promise((resolve) => setTimeout(resolve, time));

/// The reply to a request. Throws Refusal and Unreached.
export async function ask(path, { method = "GET", headers = {}, body, signal } = {}) {
  for (;;) {
    const reply = await reached(fetch(path, { method, headers: withToken(headers), body, signal, cache: "no-store" }));
    if (reply.ok) return reply;
    const refusal = await refusalOf(reply);
    if (reply.status !== 401 || !await askForToken(refusal.message)) throw refusal;
  }
}

export async function getJson(path, options = {}) {
  const reply = await ask(path, { ...options, headers: { Accept: "application/json", ...options.headers } });
  return reached(reply.json());
}

export const postJson = (path, body, signal) =>
  getJson(path, { method: "POST", body, signal, headers: { "Content-Type": "application/json" } });

/// Poses a problem, and goes to its solve.
export const pose = async (text) => location.assign((await postJson("/v1/solves", text)).links.self);

/// A document in CBOR as bytes; `onProgress` is told how many have come.
export async function getBytes(path, onProgress = () => {}) {
  const reply = await ask(path, { headers: { Accept: "application/cbor" } });
  const pieces = [];
  let length = 0;
  const reader = reply.body.getReader();
  for (let piece = await reached(reader.read()); !piece.done; piece = await reached(reader.read())) {
    pieces.push(piece.value);
    length += piece.value.length;
    onProgress(length);
  }
  const all = new Uint8Array(length);
  let at = 0;
  for (const piece of pieces) {
    all.set(piece, at);
    at += piece.length;
  }
  return all;
}

/// What `does` returns, which is tried again as long as the service is away; `lost(true | false)` says whether it is.
export async function persist(does, lost) {
  for (let wait = 100; ; wait = Math.min(2 * wait, 2000)) {
    try {
      const found = await does();
      lost(false);
      return found;
    } catch (error) {
      const passes = error instanceof Unreached || error.status >= 500 || error.status === 429;
      if (!passes) throw error;
    }
    lost(true);
    await pause(wait);
  }
}

/// Server-sent events, until the stream says that all is told; after a loss it goes on behind the last event.
/// (EventSource cannot show a token.) `tell(name, id, data)`; for `lost` see persist().
export async function follow(path, tell, lost) {
  for (let last = ""; ; lost(true), await pause(100)) {
    const reply = await persist(() => ask(path, { headers: { Accept: "text/event-stream", ...(last && { "Last-Event-ID": last }) } }), lost);
    if (reply.status === 204) return;
    const ended = await readEvents(reply, (name, id, data) => {
      if (id) last = id;
      tell(name, id, data);
      return name !== "progress";
    });
    if (ended) return;
  }
}

/// False if the stream broke before `tell` returned true.
async function readEvents(reply, tell) {
  const reader = reply.body.pipeThrough(new TextDecoderStream()).getReader();
  let text = "";
  const next = () => reader.read().catch(() => ({ done: true }));
  for (let piece = await next(); !piece.done; piece = await next()) {
    text += piece.value;
    for (let end = text.indexOf("\n\n"); end >= 0; end = text.indexOf("\n\n")) {
      const members = Object.fromEntries(text.slice(0, end).split("\n").map((line) => {
        const colon = line.indexOf(":");
        return [line.slice(0, colon), line.slice(colon + 1).trimStart()];
      }));
      text = text.slice(end + 2);
      if (members.data !== undefined && tell(members.event, members.id, JSON.parse(members.data))) {
        reader.cancel();
        return true;
      }
    }
  }
  return false;
}
