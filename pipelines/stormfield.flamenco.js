// SPDX-License-Identifier: GPL-3.0-or-later
// A bake as a Flamenco job: solve once, bake frames in chunks, join. Put this file into the Manager's folder scripts.
// The workers have Blender with the extension enabled, and share the scene's folder. A task that runs twice does no harm.

const JOB_TYPE = {
  label: "Stormfield Bake",
  description: "Solve the Stormfield fields of a scene, bake them in chunks of frames, and join the caches",
  settings: [
    {key: "frames", type: "string", required: true,
     eval: "f'{C.scene.frame_start}-{C.scene.frame_end}'", description: "Frame range, such as 1-250"},
    {key: "chunk_size", type: "int32", default: 25, propargs: {min: 1}, visible: "submission",
     description: "Frames in one task; a task loads the scene once"},
    {key: "targets", type: "string", default: "usd", description: "Comma separated: usd, exr, vdb, morse"},
    {key: "blendfile", type: "string", required: true, visible: "web", description: "The scene to bake"},
  ],
};

function compileJob(job) {
  const settings = job.settings;
  const solve = bakeTask("solve", settings, ["--solve-only"]);
  job.addTask(solve);
  const join = bakeTask("join", settings, ["--targets", settings.targets, "--join"]);
  for (const chunk of frameChunker(settings.frames, settings.chunk_size)) {
    const bake = bakeTask(`bake ${chunk}`, settings, ["--targets", settings.targets, "--frames", chunk, "--resume"]);
    bake.addDependency(solve);
    job.addTask(bake);
    join.addDependency(bake);
  }
  job.addTask(join);
}

// blender -b SCENE --command stormfield bake OPTIONS
function bakeTask(name, settings, options) {
  const task = author.Task(name, "blender");
  task.addCommand(author.Command("blender-render", {
    exe: "{blender}",
    exeArgs: "{blenderArgs}",
    argsBefore: ["-b"],
    blendfile: settings.blendfile,
    args: ["--command", "stormfield", "bake"].concat(options),
  }));
  return task;
}
