// The head of the open document: its name and state, its flows, and what is done most; below it what has to be decided.
import { ChevronRight, Columns2, Play, Redo2, Rocket, Sparkles, Undo2 } from "lucide-react";
import { kept } from "../api/storage";
import { Link as AppLink } from "../ui/link";
import { navigate, paths } from "../ui/router";
import { Crumbs } from "./crumbs";
import type { DraftSync } from "./draft_sync";
import { BehindBar, UnkeptBar } from "./live_version";
import { ServerDraftBar, ServerDraftButton } from "./server_draft";
import type { EditorModel } from "./use_editor";

export function EditorHeader({ editor }: { editor: EditorModel }) {
  const { session, sync, serverDraft } = editor;
  return (
    <>
      <header className="head">
        <Title editor={editor} />
        <span className="grow" />
        <Tools editor={editor} />
      </header>
      <UnkeptBar sync={sync} full={kept.open()} />
      <BehindBar sync={sync} />
      <ServerDraftBar draft={serverDraft} session={session} />
      <ConflictBar sync={sync} />
      <Tabs panels={editor.panels} />
    </>
  );
}

function Title({ editor }: { editor: EditorModel }) {
  const { sync, name, via, document, workflow, flowKey, dirty } = editor;
  return (
    <>
      <AppLink href={paths.documents()} className="faint crumb">
        Workflows
      </AppLink>
      <ChevronRight size={13} className="faint crumb" />
      <Crumbs via={via} />
      <h1 className="cut">{workflow}</h1>
      {dirty ? (
        <span
          className="tag accent"
          title={sync.isKept ? "Kept in this browser" : "Not kept in this browser"}
        >
          draft
        </span>
      ) : (
        <span className="tag good">deployed</span>
      )}
      {document.flows.length > 1 && (
        <nav className="segments flows" aria-label="Flows">
          {document.flows.map((f) => (
            <button
              key={f.key}
              aria-pressed={f.key === flowKey}
              onClick={() => navigate(paths.compose(name, f.key, "", via))}
            >
              {f.name}
            </button>
          ))}
        </nav>
      )}
    </>
  );
}

function Tools({ editor }: { editor: EditorModel }) {
  const { session, live, serverDraft, actions, panels, dirty, setOpen } = editor;
  return (
    <>
      <button
        className="button plain icon"
        aria-label="Undo"
        title="Undo (Ctrl-Z)"
        disabled={!session.canUndo}
        onClick={session.undo}
      >
        <Undo2 size={15} />
      </button>
      <button
        className="button plain icon"
        aria-label="Redo"
        title="Redo (Ctrl-Shift-Z)"
        disabled={!session.canRedo}
        onClick={session.redo}
      >
        <Redo2 size={15} />
      </button>
      <ServerDraftButton draft={serverDraft} dirty={dirty} />
      <button
        className="button plain wide-only"
        title="Arrange the steps (Shift-T)"
        onClick={() => actions.tidy()}
      >
        <Sparkles size={14} />
        Tidy
      </button>
      <button
        className="button plain wide-only"
        aria-pressed={panels.text}
        title="Show or hide the text (T)"
        onClick={() => panels.toggle("text")}
      >
        <Columns2 size={15} />
        Text
      </button>
      {live ? (
        <button
          className="button"
          title="Start a run by hand (R)"
          aria-label="Run"
          onClick={() => setOpen({ what: "start" })}
        >
          <Play size={13} />
          <span className="wide-only">Run</span>
        </button>
      ) : null}
      <button className="button primary" onClick={() => setOpen({ what: "deploy" })}>
        <Rocket size={14} />
        Deploy
      </button>
    </>
  );
}

function ConflictBar({ sync }: { sync: DraftSync }) {
  if (sync.conflicts.use() === null) return null;
  return (
    <div className="stale" role="alert">
      Another tab has changed the same place of this draft.
      <button className="button small" onClick={() => sync.take()}>
        Take its text
      </button>
      <button className="button small" onClick={() => sync.keep()}>
        Keep mine
      </button>
    </div>
  );
}

function Tabs({ panels }: Pick<EditorModel, "panels">) {
  return (
    <div className="narrow-tabs segments" role="tablist" aria-label="Parts of the view">
      {(["canvas", "properties", "text"] as const).map((tab) => (
        <button key={tab} role="tab" aria-selected={panels.tab === tab} onClick={() => panels.setTab(tab)}>
          {tab[0]?.toUpperCase()}
          {tab.slice(1)}
        </button>
      ))}
    </div>
  );
}
