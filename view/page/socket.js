// The connection to the server: messages both ways, and a new connection when the old one ends.

const MAGIC = 0x4c505330;
const HEADER = 32; // bytes before a payload
const WAITS = [250, 500, 1000, 2000, 4000]; // ms before each new attempt; the last one again and again

/** @typedef {import("./picture.js").Header} Header */
/** @typedef {object} Handlers
 * @property {() => void} opened  a connection stands; the server begins a new session
 * @property {(attempts: number) => void} closed  it ended, or could not be had that many times
 * @property {(message: any) => void} message  a text message
 * @property {(header: Header, payload: Uint8Array) => void} binary  a picture (kind 1, 2) or file (3)
 */

/**
 * Keep a connection to an address.
 *
 * @param {string} address  ws://...
 * @param {Handlers} handlers
 * @returns {{send: (message: object) => boolean}}  `send` says whether a connection stands
 */
export function keepConnected(address, handlers) {
  /** @type {WebSocket} */
  let socket;
  let attempts = 0;
  const connect = () => {
    socket = new WebSocket(address);
    socket.binaryType = "arraybuffer";
    socket.onopen = () => {
      attempts = 0;
      handlers.opened();
    };
    socket.onclose = () => {
      const wait = WAITS[Math.min(attempts++, WAITS.length - 1)];
      handlers.closed(attempts);
      setTimeout(connect, wait);
    };
    socket.onmessage = ({ data }) => {
      if (typeof data === "string") handlers.message(JSON.parse(data));
      else receive(data, handlers);
    };
  };
  connect();
  return {
    send(message) {
      if (socket.readyState !== WebSocket.OPEN) return false;
      socket.send(JSON.stringify(message));
      return true;
    },
  };
}

/** Hand a binary message on, or say that it cannot be read. */
function receive(/** @type {ArrayBuffer} */ data, /** @type {Handlers} */ handlers) {
  const header = data.byteLength < HEADER ? null : readHeader(data);
  if (header) handlers.binary(header, new Uint8Array(data, HEADER));
  else handlers.message({ type: "error", text: "This page does not fit its server. Load it again." });
}

/** The address of this page's socket, with this page's token. */
export function socketAddress() {
  const scheme = location.protocol === "https:" ? "wss:" : "ws:";
  const token = new URLSearchParams(location.search).get("token") ?? "";
  return `${scheme}//${location.host}/socket?token=${encodeURIComponent(token)}`;
}

/**
 * Read the header of a binary message.
 *
 * @param {ArrayBuffer} data
 * @returns {Header | null}  null: the message is of another protocol
 */
function readHeader(data) {
  const words = new DataView(data);
  const word = (/** @type {number} */ index) => words.getUint32(4 * index, true);
  if (word(0) !== MAGIC || word(7) !== data.byteLength - HEADER) return null;
  return {
    kind: word(1), frame: word(2), width: word(3), height: word(4), encoding: word(5),
    refined: (word(6) & 1) === 1,
  };
}
