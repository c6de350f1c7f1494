// Beside the page, below the code that calls the module: one request, one reply, steps in between.
let failure = "";
let [stage, told] = ["", 0];
self.poinsot_ends = text => { failure = text; };
self.poinsot_step = (now, done, total) => {
  const time = performance.now();
  if (now === stage && time - told < 50) return;
  [stage, told] = [now, time];
  postMessage({ stage, done, total });
};
const error = (code, problem) => ({ errors: [{ code, line: 0, text: `${code} ${problem}` }] });
const answered = async ({ module, verb, name, content, files, together }) => {
  await wasm_bindgen({ module_or_path: module });
  if (verb === "check") return wasm_bindgen.check_model(name, content);
  const telemetry = new wasm_bindgen.Telemetry();
  for (const file of files) telemetry.add(file.name, new Uint8Array(await file.blob.arrayBuffer()));
  return wasm_bindgen.identify_model(name, content, telemetry, together);
};
self.onmessage = async ({ data }) => {
  try {
    postMessage(JSON.parse(await answered(data)));
  } catch (cause) {
    if (failure) postMessage(JSON.parse(failure));
    else if (cause instanceof DOMException) postMessage(error("E0002", `a file cannot be read: ${cause.message}; choose it again`));
    else postMessage(error("E0006", `the browser ended the program, mostly for want of memory: ${cause.message}; use fewer rows, or the command`));
  }
};
