// three.js in Chromium without a window: one SkinnedMesh per walker with one clip, one directional light.
//
//     node three_crowd.mjs WALKER.glb PLACES.json FRAMES
//
// GAITLAB_THREE names a folder where `npm install three puppeteer-core` was run; CHROMIUM a browser other than
// /usr/bin/chromium. ANGLE names what draws: `gl` is the system's OpenGL (Mesa's llvmpipe where there is no graphics
// card, as with the other programs), `swiftshader` the browser's own. CPU is of all of the browser's processes.
import { createReadStream, readFileSync, readdirSync, writeFileSync } from 'node:fs';
import { createServer } from 'node:http';
import { createRequire } from 'node:module';
import path from 'node:path';
import { execFileSync } from 'node:child_process';
import { fileURLToPath, pathToFileURL } from 'node:url';

const [glb, places, frames] = process.argv.slice(2);
const packages = path.resolve(process.env.GAITLAB_THREE ?? '.', 'node_modules');
const page = fileURLToPath(new URL('three_crowd.html', import.meta.url));
const TICKS = Number(execFileSync('getconf', ['CLK_TCK']));
const TYPES = { '.html': 'text/html', '.js': 'text/javascript', '.glb': 'model/gltf-binary' };
const SIZE = [1280, 720], EYE = [0, 9, 30], AIM = [0, 0.9, 0], FIELD_OF_VIEW = 40;  // as frames.py

// s of CPU that a process and all below it have used.
function used(root) {
  const processes = new Map();
  for (const id of readdirSync('/proc').filter((name) => /^\d+$/.test(name))) {
    try {
      const fields = readFileSync(`/proc/${id}/stat`, 'utf8').split(') ').pop().split(' ');
      processes.set(Number(id), { parent: Number(fields[1]), ticks: Number(fields[11]) + Number(fields[12]) });
    } catch { /* it has ended */ }
  }
  const below = (id) => id === root || (processes.has(id) && below(processes.get(id).parent));
  return [...processes].reduce((sum, [id, { ticks }]) => sum + (below(id) ? ticks : 0), 0) / TICKS;
}

const server = createServer((asked, answer) => {
  const name = new URL(asked.url, 'http://here').pathname;
  const file = name === '/' ? page : name === '/walker.glb' ? glb : path.join(packages, path.normalize(name));
  answer.writeHead(200, { 'content-type': TYPES[path.extname(file)] ?? 'text/plain' });
  createReadStream(file).on('error', () => answer.end()).pipe(answer);
});
await new Promise((ready) => server.listen(0, '127.0.0.1', ready));

const require = createRequire(packages + path.sep);
const puppeteer = (await import(pathToFileURL(require.resolve('puppeteer-core')).href)).default;
const browser = await puppeteer.launch({
  executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
  protocolTimeout: 600_000,
  headless: true,
  args: [
    '--no-sandbox', '--ignore-gpu-blocklist', '--enable-unsafe-swiftshader', '--disable-gpu-watchdog',
    '--disable-background-timer-throttling', '--use-gl=angle', `--use-angle=${process.env.ANGLE ?? 'gl'}`,
  ],
});
try {
  const tab = await browser.newPage();
  tab.on('pageerror', (error) => console.error(error.message));
  await tab.goto(`http://127.0.0.1:${server.address().port}/`);
  await tab.waitForFunction('window.version', { timeout: 60_000 });
  const sorted = (values) => [...values].sort((a, b) => a - b);
  for (const [size, walkers] of Object.entries(JSON.parse(readFileSync(places, 'utf8')))) {
    const triangles = await tab.evaluate(
      (...given) => window.build(...given), walkers, SIZE, EYE, AIM, FIELD_OF_VIEW,
    );
    await tab.evaluate(() => window.run(3));
    const before = used(browser.process().pid);
    const { walls, poses } = await tab.evaluate((count) => window.run(count), Number(frames));
    const cpu = 1e3 * (used(browser.process().pid) - before) / frames;
    const [frame, pose] = [sorted(walls), sorted(poses)];
    console.log(JSON.stringify({
      walkers: Number(size),
      triangles,
      wall_p10: frame[Math.floor(frame.length / 10)],
      wall: frame[Math.floor(frame.length / 2)],
      cpu,
      poses: pose[Math.floor(pose.length / 2)],
      renderer: await tab.evaluate('window.drawnBy'),
      version: await tab.evaluate('window.version'),
    }));
  }
  const drawn = await tab.evaluate('window.picture()');
  writeFileSync('/tmp/rival-three.png', Buffer.from(drawn.split(',')[1], 'base64'));
} finally {
  await browser.close();
  server.close();
}
