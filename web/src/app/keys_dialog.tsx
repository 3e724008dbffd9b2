import { X } from "lucide-react";
import { Dialog } from "../ui/dialog";
import { Keys } from "../ui/keys";
import { allCommands } from "../ui/commands";

const onCanvas: [string, string][] = [
  ["Go from step to step", "Tab"],
  ["Select the step", "Enter"],
  ["Move it", "↑ ↓ ← →"],
  ["Select several", "Shift"],
];
// Their commands are there only where they can be used.
const ofStep: [string, string][] = [
  ["Open the flow that the step runs", "O"],
  ["Back to the flow that it was opened from", "U"],
  ["Set or remove a breakpoint", "B"],
];

const inSimulation: [string, string][] = [
  ["Play or pause", "Space"],
  ["Back, next step", "← →"],
];

// ?: the keys of this view.
export function KeysDialog({ onClose }: { onClose: () => void }) {
  const commands = allCommands().filter((command) => command.keys);
  const groups = [...new Set(commands.map((command) => command.group))];
  return (
    <Dialog label="Keys" width={640} onClose={onClose}>
      <div className="sheet-head">
        <h2 className="grow">Keys</h2>
        <button className="button plain icon small" aria-label="Close" onClick={onClose}>
          <X size={15} />
        </button>
      </div>
      <div className="sheet-body keys-list">
        {groups.map((group) => (
          <section key={group}>
            <h3>{group}</h3>
            <ul>
              {commands
                .filter((command) => command.group === group)
                .map((command) => (
                  <li key={command.title}>
                    {command.title}
                    <Keys keys={command.keys ?? ""} />
                  </li>
                ))}
            </ul>
          </section>
        ))}
        {groups.includes("Steps") && (
          <section>
            <h3>On the canvas</h3>
            <ul>
              {[
                ...onCanvas,
                ...ofStep.filter(
                  ([, key]) => !commands.some((c) => c.group !== "Everywhere" && c.keys === key),
                ),
              ].map(([title, key]) => (
                <li key={title}>
                  {title}
                  <kbd>{key}</kbd>
                </li>
              ))}
            </ul>
            <h3>In the panel of a simulation</h3>
            <ul>
              {inSimulation.map(([title, key]) => (
                <li key={title}>
                  {title}
                  <kbd>{key}</kbd>
                </li>
              ))}
            </ul>
          </section>
        )}
      </div>
      <p className="faint small sheet-foot">
        <a href="/licences.txt">Licences of the packages that the app is made of</a>
      </p>
    </Dialog>
  );
}
