// The dialog of the open document that is open.
import { Link2 } from "lucide-react";
import type { ShownFlow } from "../cawl/shown";
import { keepImported } from "../flow/palette_data";
import { StartDialog } from "../flow/start_dialog";
import { Dialog } from "../ui/dialog";
import { Picker, type PickerItem } from "../ui/picker";
import { toast } from "../ui/toasts";
import type { Actions } from "./actions";
import { DeployDialog } from "./deploy_dialog";
import { ImportDialog } from "./import_dialog";
import { QuickAdd } from "./quick_add";
import { dropServerDraft, keepSeen } from "./server_drafts";
import type { EditorModel } from "./use_editor";

export function EditorDialogs({ editor }: { editor: EditorModel }) {
  const { open, session, sync, name, document, shown, palette, actions, findings } = editor;
  const close = () => editor.setOpen(null);
  switch (open?.what) {
    case "add":
      return (
        <QuickAdd
          palette={palette.entries}
          name={document.name}
          where={open.where}
          actions={actions}
          onClose={close}
        />
      );
    case "connect":
      return shown && <ConnectDialog shown={shown} from={open.from} actions={actions} onClose={close} />;
    case "import":
      return (
        <ImportDialog
          onImported={(entries) => {
            keepImported(entries);
            palette.again();
            toast("good", `${entries.length} steps are in the palette`);
          }}
          onClose={close}
        />
      );
    case "deploy":
      return (
        <DeployDialog
          session={session}
          document={document}
          findings={findings}
          sync={sync}
          onDeployed={(text, version) => {
            editor.deployed(text, version);
            keepSeen(name, "");
            void dropServerDraft(name).catch(() => undefined);
          }}
          onClose={close}
        />
      );
    case "start":
      return (
        <StartDialog
          workflow={document.name}
          variables={editor.variables}
          flow={shown?.flow.name ?? ""}
          vocabulary={editor.vocabulary}
          prefixes={editor.prefixes}
          onClose={close}
        />
      );
    default:
      return null;
  }
}

function ConnectDialog({
  shown,
  from,
  actions,
  onClose,
}: {
  shown: ShownFlow;
  from: string;
  actions: Actions;
  onClose: () => void;
}) {
  const begins = shown.steps.find((s) => s.key === from)?.name;
  const isLinked = (to: string) =>
    shown.links.some((l) => l.kind === "plain" && l.from === begins && l.to === to);
  const ends = shown.steps.filter(
    (s) => s.key !== from && s.kind !== "source" && !s.stale && !isLinked(s.name),
  );
  return (
    <Dialog label="Connect to" top onClose={onClose}>
      <Picker
        label="Connect to"
        placeholder={`Connect ${begins ?? ""} to…`}
        empty="No step has this name."
        onDone={onClose}
        items={ends.map((s): PickerItem => ({
          id: s.key,
          title: s.name,
          detail: s.kind === "sink" ? "end of the flow" : s.invokes.map((i) => i.target).join(", "),
          icon: <Link2 size={15} />,
          run: () => actions.connect(from, s.key),
        }))}
      />
    </Dialog>
  );
}
