"use strict";
// Inputs, checks while the model is written, a run in a worker, the answer and its files.
(() => {
  const at = id => document.getElementById(id);
  const make = (tag, text = "", more = {}) => Object.assign(document.createElement(tag), { textContent: text }, more);
  const button = (text, act) => make("button", text, { type: "button", onclick: act });
  const unpacked = text => {
    const packed = new Blob([Uint8Array.from(atob(text), c => c.charCodeAt(0))]);
    return new Response(packed.stream().pipeThrough(new DecompressionStream("gzip"))).arrayBuffer();
  };
  const save = (name, text) => {
    const link = make("a", "", { href: URL.createObjectURL(new Blob([text])), download: name.split("/").pop() });
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  };

  const compiled = (async () => WebAssembly.compile(await unpacked(at("module").textContent)))();
  const script = URL.createObjectURL(new Blob([at("worker").textContent], { type: "text/javascript" }));
  // A worker for each request: to cancel is to end it, and its memory goes with it. A cancelled one gives null.
  const ask = (request, told = () => {}) => {
    const worker = new Worker(script);
    let end;
    const done = new Promise(resolve => {
      end = reply => { worker.terminate(); resolve(reply); };
      const lost = why => end({ errors: [{ code: "E0009", line: 0, text: `E0009 this browser does not run the program: ${why.message}` }] });
      worker.onmessage = ({ data }) => { if (data.stage) told(data); else end(data); };
      worker.onerror = lost;
      compiled.then(module => worker.postMessage({ module, ...request })).catch(lost);
    });
    return { done, cancel: () => end(null) };
  };

  // Name and content of each telemetry file, name of the model, the check and the run that are under way.
  let telemetry = [];
  let model = "model.toml";
  let checking = null;
  let running = null;

  const ready = () => {
    at("run").disabled = running !== null || !telemetry.length || !at("model").value.trim();
    at("cancel").hidden = at("bar").hidden = running === null;
  };

  const changed = () => {
    if (!at("answer").hidden && !running) at("said").textContent = "Model or files have changed since this answer.";
    ready();
  };

  const showFiles = () => {
    at("files").replaceChildren(...telemetry.map(file => {
      const row = make("li");
      const remove = button("Remove", () => { telemetry = telemetry.filter(other => other !== file); showFiles(); at("choose").focus(); });
      remove.setAttribute("aria-label", `Remove ${file.name}`);
      row.append(make("span", file.name), make("small", `${(file.blob.size / 1e3).toLocaleString("en", { maximumFractionDigits: 0 })} kB`), remove);
      return row;
    }));
    at("join").hidden = telemetry.length < 2;
    changed();
  };

  const LINE = 18;
  const goTo = line => {
    const field = at("model");
    const lines = field.value.split("\n");
    const start = lines.slice(0, line - 1).join("\n").length + (line > 1 ? 1 : 0);
    field.focus();
    field.setSelectionRange(start, start + lines[line - 1].length);
    field.scrollTop = (line - 6) * LINE;
  };

  // Errors below the place, those with a line as marks beside the model too.
  const list = (place, errors) => {
    at(place).replaceChildren(...errors.map(error => {
      const row = make("li");
      if (error.line) row.append(button(`Line ${error.line}`, () => goTo(error.line)));
      row.append(error.text);
      return row;
    }));
    mark(errors);
  };

  const mark = errors => {
    const count = at("model").value.split("\n").length;
    const numbers = at("gutter").firstChild;
    numbers.textContent = Array.from({ length: count }, (_, k) => k + 1).join("\n");
    for (const error of errors.filter(e => e.line)) {
      const sign = make("i", "", { title: error.text });
      sign.style.top = `${8 + (error.line - 1) * LINE + 5}px`;
      numbers.append(sign);
    }
  };

  const check = async () => {
    checking?.cancel();
    const content = at("model").value;
    mark([]);
    if (!content.trim()) {
      list("wrong", []);
      at("checked").textContent = "";
      at("says").hidden = true;
      return;
    }
    checking = ask({ verb: "check", name: model, content });
    const reply = await checking.done;
    if (!reply) return;
    const count = reply.errors.length;
    at("checked").textContent = count ? `${count} ${count > 1 ? "errors" : "error"} in the model` : "The model has no errors.";
    at("checked").className = count ? "bad" : "";
    list("wrong", reply.errors);
    at("says").hidden = !reply.vehicle;
    at("says").querySelector("pre").textContent = reply.vehicle ?? "";
  };

  const setModel = (name, content) => {
    model = name;
    at("name").textContent = name;
    at("model").value = content;
    at("model").scrollTop = 0;
    at("checked").textContent = "";
    changed();
    check();
  };

  const take = async files => {
    const models = files.filter(f => /\.toml$/i.test(f.name));
    telemetry.push(...files.filter(f => !models.includes(f)).map(f => ({ name: f.name, blob: f })));
    showFiles();
    if (models.length) setModel(models[0].name, await models[0].text());
  };

  const show = (reply, seconds) => {
    at("answer").hidden = false;
    at("answer").dataset.seconds = seconds;
    at("verdict").textContent = reply.verdict;
    at("verdict").className = `sentence ${reply.tone}`;
    at("printed").textContent = reply.text;
    at("report").srcdoc = reply.files.find(f => f.name === "report.html").text;
    at("save").replaceChildren(...reply.files.toReversed().map(f => button(`Save ${f.name}`, () => save(f.name, f.text))));
  };

  const shown = report => {
    at("report").hidden = !report;
    at("printed").hidden = report;
    at("page").setAttribute("aria-pressed", report);
    at("text").setAttribute("aria-pressed", !report);
  };

  const run = async () => {
    const began = performance.now();
    const seconds = () => (performance.now() - began) / 1000;
    const said = text => { if (at("said").textContent !== text) at("said").textContent = text; };
    const request = { verb: "identify", name: model, content: at("model").value, files: telemetry, together: at("together").checked };
    at("refused").replaceChildren();
    at("bar").removeAttribute("value");
    said("reading");
    running = ask(request, step => {
      said(step.stage);
      if (step.total) Object.assign(at("bar"), { max: step.total, value: step.done });
      else at("bar").removeAttribute("value");
    });
    const clock = setInterval(() => { at("clock").textContent = `${seconds().toFixed(1)} s`; }, 100);
    at("answer").hidden = true;
    ready();
    at("cancel").focus();
    const reply = await running.done;
    clearInterval(clock);
    running = null;
    ready();
    at("run").focus();
    at("clock").textContent = `${seconds().toFixed(1)} s`;
    if (!reply) return said("Cancelled.");
    if (reply.errors) {
      said("No answer: the reasons are below.");
      return list("refused", reply.errors);
    }
    said("Done: the answer is below.");
    show(reply, seconds());
  };

  for (const example of JSON.parse(at("shipped").textContent)) {
    const card = button("", async () => {
      telemetry = [];
      showFiles();
      const content = await unpacked(example.telemetry.packed);
      telemetry = [{ name: example.telemetry.name, blob: new Blob([content]) }];
      at("together").checked = false;
      at("answer").hidden = true;
      at("said").textContent = `${example.title}: model and telemetry are there.`;
      showFiles();
      setModel(example.model.name, example.model.text);
    });
    card.append(make("b", example.title), make("span", example.words));
    at("examples").append(card);
  }
  let pause = 0;
  at("model").oninput = () => { clearTimeout(pause); pause = setTimeout(check, 250); changed(); };
  at("model").onscroll = () => { at("gutter").scrollTop = at("model").scrollTop; };
  at("choose").onchange = event => { take([...event.target.files]); event.target.value = ""; };
  at("open").onchange = event => { take([...event.target.files]); event.target.value = ""; };
  at("keep").onclick = () => save(model, at("model").value);
  at("run").onclick = run;
  at("cancel").onclick = () => running?.cancel();
  at("page").onclick = () => shown(true);
  at("text").onclick = () => shown(false);
  const drop = document.querySelector(".drop");
  const over = is => event => { event.preventDefault(); drop.classList.toggle("over", is); };
  document.ondragover = over(true);
  document.ondragleave = over(false);
  document.ondrop = event => { over(false)(event); take([...event.dataTransfer.files]); };
  setModel(model, "");
})();
