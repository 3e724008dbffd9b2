export default function Board(_: object) { return <main className="view nothing"><p>Not yet.</p></main>; }
