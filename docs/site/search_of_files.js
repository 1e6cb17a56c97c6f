// The search of the site in pages that are opened as files. There a browser starts no worker and loads no JSON: the
// index comes as a script, and the worker runs in a hidden frame.
if (location.protocol === "file:") {
  const base = document.currentScript.dataset.base;
  document.write(`<script src="${base}search/search_index.js"><\/script>`);

  window.Worker = class extends EventTarget {
    constructor(script) {
      super();
      const frame = document.createElement("iframe");
      frame.hidden = true;
      document.body.append(frame);
      this.begun = new Promise((begin) => {
        addEventListener("message", (event) => {
          if (event.source !== frame.contentWindow) return;
          if (event.data === "begun") begin(frame.contentWindow);
          else this.dispatchEvent(new MessageEvent("message", { data: event.data }));
        });
      });
      frame.contentDocument.open();
      frame.contentDocument.write(
        `<script>var postMessage = (message) => parent.postMessage(message, "*"), importScripts = () => {};<\/script>` +
          `<script src="${script}"><\/script><script>postMessage("begun");<\/script>`);
      frame.contentDocument.close();
    }
    postMessage(message) {
      this.begun.then((worker) => worker.dispatchEvent(new MessageEvent("message", { data: message })));
    }
  };
  window.__search = {
    index: new Promise((found) => addEventListener("DOMContentLoaded", () => found(window.searchIndex))),
  };
}
