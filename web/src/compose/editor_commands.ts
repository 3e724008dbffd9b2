// What can be done with the open document, as commands.
import {
  CircleDot,
  CodeXml,
  Copy,
  Crosshair,
  Download,
  FlaskConical,
  History,
  Link2,
  PanelLeftOpen,
  Play,
  Plus,
  Redo2,
  Rocket,
  Scissors,
  Sparkles,
  TextCursorInput,
  Trash2,
  Undo2,
  WandSparkles,
  Workflow,
} from "lucide-react";
import { type Command, useCommands } from "../ui/commands";
import { toast } from "../ui/toasts";
import { saveFile } from "./files";
import { type EditorModel, jumpTo, openStep, placeOfNew } from "./use_editor";

const mostRemedies = 100;

export function useEditorCommands(editor: EditorModel) {
  useCommands([
    ...commandsOfStep(editor),
    ...commandsOfSelection(editor),
    ...commandsOfDocument(editor),
    ...commandsOfView(editor),
    ...commandsOfFindings(editor),
    ...(editor.shown?.steps ?? []).map((s): Command => ({
      title: `Go to step ${s.name}`,
      group: "Go to",
      words: "node",
      run: () => editor.selection.select([s.key], [], true),
    })),
  ]);
}

function commandsOfStep(editor: EditorModel): Command[] {
  const { selection, breakpoints, nameField, setOpen } = editor;
  const { only } = selection;
  return [
    {
      title: "Add a step",
      group: "Steps",
      icon: Plus,
      keys: "/",
      words: "insert new",
      run: () => setOpen({ what: "add", where: placeOfNew(editor) }),
    },
    {
      title: "Connect to…",
      group: "Steps",
      icon: Link2,
      keys: "C",
      words: "link",
      run: () =>
        only && only.kind !== "sink"
          ? setOpen({ what: "connect", from: only.key })
          : toast("bad", "Select one step first", "Then C connects it to another one, by name."),
    },
    ...(only?.invokes.some((i) => i.kind === "subflow")
      ? [
          {
            title: `Open the flow of ${only.name}`,
            group: "Steps",
            icon: Workflow,
            keys: "O",
            words: "module in place",
            run: () => openStep(editor, only.key),
          },
        ]
      : []),
    {
      title: "Rename",
      group: "Steps",
      icon: TextCursorInput,
      keys: "F2",
      run: () => nameField.current?.select(),
    },
    ...(only?.kind === "node"
      ? [
          {
            title: `${breakpoints.steps.has(only.name) ? "Remove the breakpoint at" : "Set a breakpoint at"} ${only.name}`,
            group: "Steps",
            icon: CircleDot,
            keys: "B",
            words: "simulate stop debug",
            run: () => breakpoints.toggle(only.name),
          },
        ]
      : []),
  ];
}

function commandsOfSelection({ selection, actions, clipboard, shown }: EditorModel): Command[] {
  const steps = () => [...selection.steps];
  return [
    {
      title: "Remove",
      group: "Steps",
      icon: Trash2,
      keys: "Delete|Backspace",
      onCanvas: true,
      words: "delete",
      run: () => actions.remove(steps(), [...selection.links]),
    },
    {
      title: "Copy",
      group: "Steps",
      icon: Copy,
      keys: "Mod+C",
      onCanvas: true,
      run: () => clipboard.copy(steps()),
    },
    {
      title: "Cut",
      group: "Steps",
      icon: Scissors,
      keys: "Mod+X",
      onCanvas: true,
      run: () => {
        clipboard.copy(steps());
        actions.remove(steps(), []);
      },
    },
    { title: "Paste", group: "Steps", keys: "Mod+V", onCanvas: true, run: () => void clipboard.paste() },
    {
      title: "Duplicate",
      group: "Steps",
      keys: "Mod+D",
      onCanvas: true,
      run: () => actions.paste(actions.copied(steps())),
    },
    {
      title: "Select all",
      group: "Steps",
      keys: "Mod+A",
      onCanvas: true,
      run: () => selection.select(shown?.steps.filter((s) => !s.stale).map((s) => s.key) ?? [], []),
    },
    {
      title: "Select nothing",
      group: "Steps",
      keys: "Escape",
      hidden: true,
      run: () => selection.select([], []),
    },
  ];
}

function commandsOfDocument({ session, actions, workflow, lower, setOpen }: EditorModel): Command[] {
  return [
    { title: "Undo", group: "Document", icon: Undo2, keys: "Mod+Z", run: session.undo },
    { title: "Redo", group: "Document", icon: Redo2, keys: "Mod+Shift+Z|Mod+Y", run: session.redo },
    {
      title: "Tidy up",
      group: "Document",
      icon: Sparkles,
      keys: "Shift+T",
      words: "layout arrange",
      run: () => actions.tidy(),
    },
    {
      title: "Deploy",
      group: "Document",
      icon: Rocket,
      keys: "Mod+Enter",
      words: "publish",
      run: () => setOpen({ what: "deploy" }),
    },
    { title: "Start a run", group: "Document", icon: Play, keys: "R", run: () => setOpen({ what: "start" }) },
    {
      title: "Try on past runs",
      group: "Document",
      icon: History,
      keys: "Shift+R",
      words: "replay test",
      run: () => lower.toggle("trials"),
    },
    {
      title: "Simulate",
      group: "Document",
      icon: FlaskConical,
      keys: "Shift+S",
      words: "play try robots simulation",
      run: () => lower.toggle("simulate"),
    },
    {
      title: "Import steps",
      group: "Document",
      words: "wsdl grpc adapter",
      run: () => setOpen({ what: "import" }),
    },
    {
      title: "Save a copy as a file",
      group: "Document",
      icon: Download,
      keys: "Mod+S",
      inFields: true,
      run: () => saveFile(`${workflow}.cawl.xml`, session.written),
    },
  ];
}

function commandsOfView({ panels }: EditorModel): Command[] {
  return [
    {
      title: "Show or hide the text",
      group: "Document",
      icon: CodeXml,
      keys: "T",
      run: () => panels.toggle("text"),
    },
    {
      title: "Show or hide the palette",
      group: "Document",
      icon: PanelLeftOpen,
      keys: "P",
      run: () => panels.toggle("palette"),
    },
  ];
}

function commandsOfFindings(editor: EditorModel): Command[] {
  const { list } = editor.findings;
  const first = list[0];
  const goTo: Command[] = first
    ? [
        {
          title: "Go to the first finding",
          group: "Document",
          icon: Crosshair,
          keys: "E",
          run: () => jumpTo(editor, first),
        },
      ]
    : [];
  const remedies = list.filter((f) => f.fix.length > 0).slice(0, mostRemedies);
  return [
    ...goTo,
    ...remedies.map((f): Command => ({
      title: `Mend: ${f.message}`,
      group: "Findings",
      icon: WandSparkles,
      run: () => editor.onFix(f),
    })),
  ];
}
