"use strict";
// Runs before the terminal's own script: tells it where the server is, then watches whether the server answers.
{
  const terminal = document.getElementById("terminal");
  const scheme = location.protocol === "https:" ? "wss:" : "ws:";
  terminal.dataset.sessionWebsocketUrl = `${scheme}//${location.host}/ws`;
  const asked = Number(new URLSearchParams(location.search).get("fontsize"));
  terminal.dataset.fontSize = asked >= 6 && asked <= 60 ? asked : 16;

  // Keys go to the terminal as soon as it is connected, and again after a click beside it.
  const page = document.body;
  const focus = () => page.classList.contains("-loaded") && terminal.querySelector("textarea")?.focus();
  new MutationObserver(focus).observe(page, { attributeFilter: ["class"] });
  document.addEventListener("click", focus);

  // A lost network closes no connection for minutes: without this line, an old verdict would look like a new one.
  const stale = document.getElementById("stale");
  const LATE_S = 4, EVERY_MS = 1000;
  let answered = performance.now();
  async function ask() {
    try {
      const answer = await fetch("/alive", { cache: "no-store", signal: AbortSignal.timeout(3000) });
      if (answer.ok) answered = performance.now();
    } catch { /* no answer */ }
    const late = Math.round((performance.now() - answered) / 1000);
    stale.hidden = late < LATE_S;
    stale.textContent = `The advisor has not answered for ${late} s. The values below are old.`;
    setTimeout(ask, EVERY_MS);
  }
  ask();
}
