// The widget's part in the browser; it follows modules of the page in one module: see widget.py.

/** Show a view: a canvas, and below it what its picture takes in hardware. */
function render({ model, el }) {
  const stage = document.createElement("div");
  stage.style.cssText = "max-width:100%;border-radius:6px;overflow:hidden";
  stage.style.width = `${model.get("width")}px`;
  stage.style.aspectRatio = `${model.get("width")} / ${model.get("height")}`;
  stage.style.background = model.get("background");
  stage.dataset.lmSuppressShortcuts = "true"; // JupyterLab leaves the keys to the canvas
  const line = document.createElement("div");
  line.style.cssText = "font:12px/1.6 system-ui,sans-serif;opacity:.75;min-height:1.6em";
  line.setAttribute("role", "status");
  el.append(stage, line);

  const canvas = attachCanvas(stage, (message) => model.send(message));
  const answers = {
    picture: (message, buffers) => canvas.show(message, buffers[0]),
    settings: (message) => canvas.settings(message),
    numbers: (message) => { line.textContent = numbersLine(message); },
    error: (message) => { line.textContent = message.text; },
    file: ({ name, mime }, buffers) => download(name, mime, buffers[0]),
  };
  const receive = (message, buffers) => answers[message.type]?.(message, buffers);
  model.on("msg:custom", receive);
  model.send({ type: "hello" });
  return () => {
    model.off("msg:custom", receive);
    canvas.detach();
  };
}

/** What a picture takes, in a line. */
function numbersLine({ codewords, cycles, fps, clock_mhz }) {
  const count = (value) => Math.round(value).toLocaleString("en");
  const rate = fps ? ` \u00b7 ${count(fps)} frames a second at ${count(clock_mhz)} MHz` : "";
  return `${count(codewords)} code words \u00b7 ${count(cycles)} cycles${rate}`;
}

export default { render };
