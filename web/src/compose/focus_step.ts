// Gives a step of the canvas the keyboard, as soon as it is drawn and no dialog stands before it: a dialog that closes gives the
// keyboard back to where it was.
const patienceMs = 3000;

export function focusStep(key: string) {
  const until = Date.now() + patienceMs;
  let quiet = 0; // frames in which it has had the keyboard
  const look = () => {
    const step = document.querySelector<HTMLElement>(`.react-flow__node[data-id="${CSS.escape(key)}"]`);
    const free = document.querySelector("dialog[open]") === null;
    const elsewhere = document.activeElement !== step && document.activeElement !== document.body;
    if (step && free && document.activeElement === step) quiet++;
    else if (quiet > 0 && free && elsewhere)
      return; // somebody has gone on
    else {
      quiet = 0;
      if (step && free) step.focus();
    }
    if (quiet < 6 && Date.now() < until) requestAnimationFrame(look);
  };
  requestAnimationFrame(look);
}
