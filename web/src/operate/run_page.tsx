export default function RunPage(_: { id: string; node: string }) { return <main className="view nothing"><p>Not yet.</p></main>; }
