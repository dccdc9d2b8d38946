// A language server for YAML, asked as an editor asks it: documents with their names and texts, told in JSON-RPC.
import { spawn } from 'node:child_process';
import { dirname, join } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';

const program = join(dirname(fileURLToPath(import.meta.url)), 'node_modules/yaml-language-server/bin/yaml-language-server');

export class LanguageServer {
  constructor() {
    Object.assign(this, { asked: 0, answers: new Map(), told: new Map(), waiting: new Map(), rest: Buffer.alloc(0) });
    this.child = spawn(process.execPath, [program, '--stdio'], { stdio: ['pipe', 'pipe', 'inherit'] });
    this.child.stdout.on('data', data => this.read(data));
    this.child.on('exit', code => { if (!this.ended) throw new Error(`the language server ended with ${code}`); });
  }
  async begin() {
    await this.ask('initialize', { processId: process.pid, rootUri: null, capabilities: { textDocument: { completion: { completionItem: { snippetSupport: true } }, hover: { contentFormat: ['markdown'] } }, workspace: { configuration: true } } });
    this.tell('initialized', {});
    return this;
  }
  end() {
    this.ended = true;
    this.child.kill();
  }

  // Opens a document; its problems as { line, column, message }, from 1.
  async problems(file, text) {
    const uri = pathToFileURL(file).href;
    this.told.delete(uri);
    this.tell('textDocument/didOpen', { textDocument: { uri, languageId: 'yaml', version: 1, text } });
    const found = this.told.get(uri) ?? await new Promise(done => this.waiting.set(uri, done));
    return found.map(d => ({ line: d.range.start.line + 1, column: d.range.start.character + 1, message: d.message }));
  }
  // What can stand at the end of a text.
  async completions(file, text) {
    const list = await this.at('completion', file, text);
    return (list.items ?? list).map(item => item.label);
  }
  async hover(file, text, line, column) {
    return (await this.at('hover', file, text, { line: line - 1, character: column - 1 }))?.contents?.value ?? '';
  }

  async at(what, file, text, position) {
    await this.problems(file, text);
    const lines = text.split('\n');
    return this.ask(`textDocument/${what}`, { textDocument: { uri: pathToFileURL(file).href }, position: position ?? { line: lines.length - 1, character: lines.at(-1).length } });
  }
  ask(method, params) {
    const id = ++this.asked;
    this.send({ id, method, params });
    return new Promise((done, fail) => this.answers.set(id, { done, fail }));
  }
  tell(method, params) { this.send({ method, params }); }
  send(message) {
    const body = JSON.stringify({ jsonrpc: '2.0', ...message });
    this.child.stdin.write(`Content-Length: ${Buffer.byteLength(body)}\r\n\r\n${body}`);
  }
  read(data) {
    this.rest = Buffer.concat([this.rest, data]);
    for (;;) {
      const head = this.rest.indexOf('\r\n\r\n'), length = head < 0 ? NaN : +/Content-Length: (\d+)/i.exec(this.rest.subarray(0, head))[1];
      if (!(this.rest.length >= head + 4 + length)) return;
      this.take(JSON.parse(this.rest.subarray(head + 4, head + 4 + length)));
      this.rest = this.rest.subarray(head + 4 + length);
    }
  }
  take({ id, method, params, result, error }) {
    if (method === 'workspace/configuration') {
      // Nothing is fetched: schemas are those that documents name.
      this.send({ id, result: params.items.map(item => item.section === 'yaml' ? { validate: true, completion: true, hover: true, schemaStore: { enable: false } } : {}) });
    } else if (method && id != null) {
      this.send({ id, result: null });
    } else if (method === 'textDocument/publishDiagnostics') {
      this.told.set(params.uri, params.diagnostics);
      this.waiting.get(params.uri)?.(params.diagnostics);
      this.waiting.delete(params.uri);
    } else if (this.answers.has(id)) {
      const { done, fail } = this.answers.get(id);
      this.answers.delete(id);
      if (error) fail(new Error(error.message)); else done(result);
    }
  }
}
