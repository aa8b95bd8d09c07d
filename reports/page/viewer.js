/* The 3D view of report.html: one renderer that moves from card to card. Without three.js (not there when the program was
 * built) or without WebGL the cards keep their pictures and tables. */
(function () {
  'use strict';
  var cards = document.querySelectorAll('.view[data-view]');
  if (!cards.length || !window.THREE) return;
  var THREE = window.THREE;
  var faded = new THREE.Color(0xc9ced4);
  var shared = null; // renderer, made with the first view
  var open = null;   // the view that is shown

  /* ---- Data ---- */

  function bytes(text) {
    var raw = atob(text), made = new Uint8Array(raw.length);
    for (var i = 0; i < raw.length; i++) made[i] = raw.charCodeAt(i);
    return made;
  }

  function numbers(text) { // 16 bits each, little-endian
    var b = bytes(text), made = new Uint16Array(b.length / 2);
    for (var i = 0; i < made.length; i++) made[i] = b[2 * i] | (b[2 * i + 1] << 8);
    return made;
  }

  // Metres about the middle of the cube, so that small plants and large ones are drawn alike.
  function positions(data, text) {
    var n = numbers(text), made = new Float32Array(n.length);
    for (var i = 0; i < n.length; i++) made[i] = (n[i] - 32768) * data.step;
    return made;
  }

  function cardOf(element) { return element.closest('.card'); }

  /* ---- Things to draw ---- */

  function pointCloud(data, wanted) {
    var xyz = positions(data, data.points.xyz), organ = numbers(data.points.organ), kept = [], i;
    for (i = 0; i < organ.length; i++) if (wanted(data.organs[organ[i]])) kept.push(i);
    var place = new Float32Array(3 * kept.length), number = new Uint16Array(kept.length);
    for (i = 0; i < kept.length; i++) {
      place.set(xyz.subarray(3 * kept[i], 3 * kept[i] + 3), 3 * i);
      number[i] = organ[kept[i]];
    }
    var geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.BufferAttribute(place, 3));
    geometry.setAttribute('color', new THREE.BufferAttribute(new Float32Array(place.length), 3));
    var material = new THREE.PointsMaterial({ size: 1.6, sizeAttenuation: false, vertexColors: THREE.VertexColors });
    var made = new THREE.Points(geometry, material);
    made.userData.organ = number;
    return made;
  }

  // Triangles with corners of their own: an organ's colour ends sharply.
  function surface(data, mesh) {
    var xyz = positions(data, mesh.xyz), corner = numbers(mesh.corner), organ = numbers(mesh.organ);
    var place = new Float32Array(3 * corner.length), number = new Uint16Array(corner.length);
    for (var i = 0; i < corner.length; i++) {
      place.set(xyz.subarray(3 * corner[i], 3 * corner[i] + 3), 3 * i);
      number[i] = organ[(i / 3) | 0];
    }
    var geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.BufferAttribute(place, 3));
    geometry.setAttribute('color', new THREE.BufferAttribute(new Float32Array(place.length), 3));
    geometry.computeVertexNormals();
    var material = new THREE.MeshLambertMaterial({ vertexColors: THREE.VertexColors, side: THREE.DoubleSide });
    var made = new THREE.Mesh(geometry, material);
    made.userData.organ = number;
    return made;
  }

  function hullOf(data) {
    var geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.BufferAttribute(positions(data, data.hull.xyz), 3));
    geometry.setIndex(new THREE.BufferAttribute(numbers(data.hull.corner), 1));
    var group = new THREE.Group();
    group.add(new THREE.Mesh(geometry, new THREE.MeshBasicMaterial({
      color: 0x0072b2, transparent: true, opacity: 0.1, depthWrite: false, side: THREE.DoubleSide })));
    group.add(new THREE.LineSegments(new THREE.EdgesGeometry(geometry, 1),
      new THREE.LineBasicMaterial({ color: 0x0072b2, transparent: true, opacity: 0.35 })));
    return group;
  }

  function paint(view) {
    var colours = view.data.organs.map(function (organ, number) {
      var colour = new THREE.Color(organ.colour);
      return view.chosen >= 0 && number !== view.chosen ? colour.lerp(faded, 0.8) : colour;
    });
    view.painted.forEach(function (thing) {
      var organ = thing.userData.organ, colour = thing.geometry.attributes.color;
      for (var i = 0; i < organ.length; i++) colours[organ[i]].toArray(colour.array, 3 * i);
      colour.needsUpdate = true;
    });
  }

  /* ---- Choosing an organ ---- */

  function rowOf(view, organ) {
    return cardOf(view.box).querySelector('tr[data-organ="' + organ.organ + ':' + organ.organ_id + '"]');
  }

  function addRow(table, name, value, title) {
    var row = table.insertRow(), head = document.createElement('th');
    head.textContent = name;
    row.appendChild(head);
    var cell = row.insertCell();
    cell.textContent = value;
    if (title) cell.title = title;
  }

  function tell(view) {
    var organ = view.data.organs[view.chosen], card = cardOf(view.box);
    card.querySelectorAll('tr.chosen').forEach(function (row) { row.classList.remove('chosen'); });
    view.told.hidden = !organ;
    view.told.textContent = '';
    if (!organ) return;
    var heading = document.createElement('h3'), swatch = document.createElement('span');
    swatch.className = 'swatch';
    swatch.style.background = organ.colour;
    heading.appendChild(swatch);
    heading.appendChild(document.createTextNode(organ.organ + (organ.organ_id >= 0 ? ' ' + organ.organ_id : '')));
    view.told.appendChild(heading);
    var row = rowOf(view, organ);
    if (!row) return;
    row.classList.add('chosen');
    row.closest('details').open = true;
    var names = row.closest('table').tHead.rows[0].cells, table = document.createElement('table');
    for (var i = 1; i < row.cells.length; i++)
      addRow(table, names[i].textContent, row.cells[i].textContent, row.cells[i].title);
    view.told.appendChild(table);
  }

  function choose(view, number) {
    view.chosen = number;
    paint(view);
    tell(view);
    draw(view);
  }

  function numberOf(view, name) {
    for (var i = 0; i < view.data.organs.length; i++)
      if (view.data.organs[i].organ + ':' + view.data.organs[i].organ_id === name) return i;
    return -1;
  }

  // The organ under a pixel: the nearest of what is shown; of points, those within four pixels.
  function organAt(view, x, y) {
    var box = shared.renderer.domElement.getBoundingClientRect(), ray = new THREE.Raycaster();
    ray.setFromCamera(new THREE.Vector2(2 * (x - box.left) / box.width - 1, 1 - 2 * (y - box.top) / box.height), view.camera);
    var distance = view.camera.position.distanceTo(view.controls.target);
    ray.params.Points.threshold = 4 * 2 * distance * Math.tan(view.camera.fov * Math.PI / 360) / box.height;
    var shown = view.painted.filter(function (thing) { return thing.visible; });
    var hits = ray.intersectObjects(shown), best = null;
    hits.forEach(function (hit) { if (!best || hit.distance < best.distance) best = hit; });
    if (!best) return -1;
    return best.object.userData.organ[best.face ? best.face.a : best.index];
  }

  /* ---- Drawing ---- */

  function draw(view) {
    if (view !== open) return;
    shared.renderer.render(view.scene, view.camera);
  }

  function fit(view) {
    var width = view.stage.clientWidth, height = view.stage.clientHeight;
    shared.renderer.setSize(width, height, false);
    view.camera.aspect = width / height;
    view.camera.updateProjectionMatrix();
    draw(view);
  }

  function lookFrom(view, direction) {
    var sphere = new THREE.Box3().setFromObject(view.organs).getBoundingSphere(new THREE.Sphere());
    var distance = 0.85 * sphere.radius / Math.sin(view.camera.fov * Math.PI / 360);
    view.controls.target.copy(sphere.center);
    view.camera.position.copy(sphere.center).addScaledVector(direction.normalize(), distance);
    view.camera.near = distance / 100;
    view.camera.far = distance * 100;
    view.camera.updateProjectionMatrix();
    view.controls.update();
    draw(view);
  }

  function tool(view, label, thing, on) {
    if (!thing) return;
    var holder = document.createElement('label'), box = document.createElement('input');
    box.type = 'checkbox';
    box.checked = thing.visible = on;
    box.name = label;
    box.addEventListener('change', function () { thing.visible = box.checked; draw(view); });
    holder.appendChild(box);
    holder.appendChild(document.createTextNode(' ' + label));
    view.tools.appendChild(holder);
  }

  function button(view, label, action) {
    var made = document.createElement('button');
    made.type = 'button';
    made.textContent = label;
    made.addEventListener('click', action);
    view.tools.appendChild(made);
  }

  function makeRenderer() {
    var renderer = new THREE.WebGLRenderer({ antialias: true, preserveDrawingBuffer: true });
    renderer.setPixelRatio(Math.min(window.devicePixelRatio || 1, 2));
    renderer.setClearColor(0xf5f6f8);
    var down = null;
    renderer.domElement.addEventListener('mousedown', function (e) { down = [e.clientX, e.clientY]; });
    renderer.domElement.addEventListener('click', function (e) { // a drag turns, a click chooses
      if (!open || (down && Math.hypot(e.clientX - down[0], e.clientY - down[1]) > 4)) return;
      choose(open, organAt(open, e.clientX, e.clientY));
    });
    window.addEventListener('resize', function () { if (open) fit(open); });
    return { renderer: renderer };
  }

  function make(view) {
    var data = view.data;
    view.scene = new THREE.Scene();
    view.scene.add(new THREE.HemisphereLight(0xffffff, 0x9a9a9a, 0.75));
    var sun = new THREE.DirectionalLight(0xffffff, 0.45);
    sun.position.set(-1, -0.6, 2);
    view.scene.add(sun);
    var isPlant = function (organ) { return organ.organ !== 'ground' && organ.organ !== 'other'; };
    var hasPlant = data.organs.some(isPlant);
    view.organs = pointCloud(data, function (organ) { return !hasPlant || isPlant(organ); });
    var rest = hasPlant && data.organs.some(function (organ) { return !isPlant(organ); }) ?
      pointCloud(data, function (organ) { return !isPlant(organ); }) : null;
    var leaves = data.leaves ? surface(data, data.leaves) : null, hull = data.hull ? hullOf(data) : null;
    view.painted = [view.organs, rest, leaves].filter(Boolean);
    [view.organs, rest, leaves, hull].forEach(function (thing) { if (thing) view.scene.add(thing); });
    view.camera = new THREE.PerspectiveCamera(35, 1, 0.001, 1000);
    view.camera.up.set(0, 0, 1);
    view.controls = new THREE.OrbitControls(view.camera, view.stage);
    view.controls.addEventListener('change', function () { draw(view); });
    tool(view, 'points', view.organs, true);
    tool(view, 'leaf surfaces', leaves, true);
    tool(view, 'convex hull', hull, false);
    tool(view, 'pot and other', rest, false);
    button(view, 'side', function () { lookFrom(view, new THREE.Vector3(0.25, -1, 0.15)); });
    button(view, 'top', function () { lookFrom(view, new THREE.Vector3(0, -0.001, 1)); });
    button(view, 'no organ', function () { choose(view, -1); });
    button(view, 'close', function () { close(view); });
    var note = document.createElement('span');
    note.textContent = data.points.count < data.points.of ?
      data.points.count + ' of ' + data.points.of + ' points' : data.points.count + ' points';
    view.tools.appendChild(note);
  }

  function dispose(thing) {
    thing.traverse(function (part) {
      if (part.geometry) part.geometry.dispose();
      if (part.material) part.material.dispose();
    });
  }

  function close(view) {
    view.controls.dispose();
    dispose(view.scene);
    view.box.removeChild(view.holder);
    view.button.hidden = false;
    tell({ box: view.box, told: view.told, data: view.data, chosen: -1 });
    if (open === view) open = null;
  }

  function show(box, opener) {
    if (open) close(open);
    try {
      shared = shared || makeRenderer();
    } catch (failure) {
      opener.textContent = 'This browser has no WebGL: no 3D view';
      opener.disabled = true;
      return null;
    }
    var view = { box: box, button: opener, chosen: -1 };
    view.data = JSON.parse(document.getElementById('view-' + box.dataset.view).textContent);
    view.holder = document.createElement('div');
    view.tools = document.createElement('div');
    view.tools.className = 'tools';
    view.stage = document.createElement('div');
    view.stage.className = 'stage';
    view.told = document.createElement('div');
    view.told.className = 'told';
    view.told.hidden = true;
    view.stage.appendChild(shared.renderer.domElement);
    view.stage.appendChild(view.told);
    view.holder.appendChild(view.tools);
    view.holder.appendChild(view.stage);
    box.appendChild(view.holder);
    opener.hidden = true;
    open = box.plantimeter = view; // for scripts that look at the page
    make(view);
    paint(view);
    fit(view);
    lookFrom(view, new THREE.Vector3(0.25, -1, 0.15));
    return view;
  }

  cards.forEach(function (box) {
    var opener = document.createElement('button');
    opener.type = 'button';
    opener.textContent = '3D view';
    opener.addEventListener('click', function () { show(box, opener); });
    box.appendChild(opener);
    cardOf(box).addEventListener('click', function (e) { // a row of the tables chooses its organ in the view
      var row = e.target.closest('tr[data-organ]');
      if (!row) return;
      var view = open && open.box === box ? open : show(box, opener);
      if (view) choose(view, numberOf(view, row.dataset.organ));
    });
  });

  // report.html#view=PLANT or #view=PLANT/leaf:2 opens a view, so that an organ can be pointed to by a link.
  function follow() {
    var asked = /^#view=([^/]*)(?:\/(.*))?$/.exec(decodeURIComponent(window.location.hash));
    if (!asked) return;
    cards.forEach(function (box) {
      if (cardOf(box).dataset.plant !== asked[1]) return;
      var view = show(box, box.querySelector('button'));
      if (!view) return;
      if (asked[2]) choose(view, numberOf(view, asked[2]));
      box.scrollIntoView();
    });
  }
  window.addEventListener('hashchange', follow);
  follow();
})();
