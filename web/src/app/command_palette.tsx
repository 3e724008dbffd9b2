import { ChevronRight } from "lucide-react";
import { Dialog } from "../ui/dialog";
import { Keys } from "../ui/keys";
import { Picker } from "../ui/picker";
import { allCommands, useCommandsVersion } from "../ui/commands";

// Ctrl-K: everything that can be done here, found by typing.
export function CommandPalette({ onClose }: { onClose: () => void }) {
  useCommandsVersion();
  const items = allCommands()
    .filter((command) => !command.hidden)
    .map((command, i) => ({
      id: `${i} ${command.title}`,
      title: command.title,
      group: command.group,
      run: command.run,
      icon: command.icon ? <command.icon size={16} /> : <ChevronRight size={16} />,
      ...(command.words && { words: command.words }),
      ...(command.keys && { end: <Keys keys={command.keys} /> }),
    }));
  return (
    <Dialog label="Commands" width={560} top onClose={onClose}>
      <Picker
        label="Commands"
        placeholder="What do you want to do?"
        items={items}
        empty="No command has these words."
        onDone={onClose}
      />
    </Dialog>
  );
}
