// Saves every answer as it is given, and says when it is safe. Without this script the form saves page by page.
"use strict";
(() => {
  const form = document.querySelector("form.questions");
  const told = document.querySelector(".missing");
  if (told) told.focus();
  if (!form) return;

  const status = form.querySelector(".saved");
  const waiting = new Map(); // question -> value that is not yet confirmed
  const pauses = new Map(); // question -> timer while somebody writes
  let isSending = false;
  let wait = 500;

  function say(text, isBad) {
    status.textContent = text;
    status.classList.toggle("not", Boolean(isBad));
  }

  async function send() {
    if (isSending || waiting.size === 0) return;
    isSending = true;
    const [question, value] = waiting.entries().next().value;
    try {
      const answer = await fetch(form.dataset.save, {
        method: "POST",
        headers: { "Content-Type": "application/json" },
        body: JSON.stringify({ question, value }),
        keepalive: true,
      });
      if (answer.ok) {
        wait = 500;
        if (waiting.get(question) === value) waiting.delete(question);
        if (waiting.size === 0 && pauses.size === 0) say("Saved.");
      } else if (answer.status === 503) {
        throw new Error("busy");
      } else {
        waiting.delete(question);
        say("This answer cannot be saved: " + (await answer.json()).error, true);
      }
    } catch {
      say("Not saved yet; trying again. Please leave this page open.", true);
      await new Promise((done) => setTimeout(done, wait));
      wait = Math.min(2 * wait, 8000);
    }
    isSending = false;
    send();
  }

  function keep(question, value) {
    clearTimeout(pauses.get(question));
    pauses.delete(question);
    waiting.set(question, value);
    say("Saving ...");
    send();
  }

  form.addEventListener("change", ({ target }) => keep(target.name, target.value));
  form.addEventListener("input", ({ target }) => {
    if (target.type !== "textarea") return;
    clearTimeout(pauses.get(target.name));
    say("Saving ...");
    pauses.set(target.name, setTimeout(() => keep(target.name, target.value), 800));
  });
  // whoever leaves in the middle of a word loses none of it
  document.addEventListener("visibilitychange", () => {
    if (document.visibilityState !== "hidden") return;
    for (const name of [...pauses.keys()]) keep(name, form.elements[name].value);
  });
  form.addEventListener("submit", () => { // the form itself brings all answers of the page
    waiting.clear();
    pauses.forEach((timer) => clearTimeout(timer));
    pauses.clear();
  });
  window.addEventListener("beforeunload", (event) => {
    if (waiting.size > 0) event.preventDefault();
  });
})();
