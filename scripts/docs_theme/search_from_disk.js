// Search in pages that are read from a disk, where browsers start no worker: its script runs in a hidden frame.
window.Worker = class extends EventTarget {
  constructor(script) {
    super();
    const frame = document.createElement("iframe");
    frame.hidden = true;
    document.body.append(frame);
    const inside = (this.inside = frame.contentWindow);
    inside.document.open();
    inside.tell = (data) => this.dispatchEvent(new MessageEvent("message", { data }));
    this.ready = new Promise((done) => (inside.isReady = done));
    inside.document.write(`<script>postMessage = (data) => tell(data)<\/script><script src="${new URL(script, location.href)}"><\/script><script>isReady()<\/script>`);
    inside.document.close();
  }
  postMessage(data) {
    this.ready.then(() => this.inside.dispatchEvent(new MessageEvent("message", { data })));
  }
  terminate() {}
};
