import { Component, type ReactNode } from "react";

// A mistake of the app in one view leaves the rest usable.
export class Guard extends Component<{ children: ReactNode }, { error: Error | null }> {
  override state = { error: null as Error | null };
  static getDerivedStateFromError(error: Error) {
    return { error };
  }
  override render() {
    if (!this.state.error) return this.props.children;
    return (
      <main className="view nothing">
        <h1>This view has stopped</h1>
        <p>{this.state.error.message}</p>
        <p>
          Your text is kept.{" "}
          <button className="button" onClick={() => this.setState({ error: null })}>
            Open the view again
          </button>
        </p>
      </main>
    );
  }
}
