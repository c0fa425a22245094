/* marotte rig: rigs for faces. */
#include "rig.h"

#include <string.h>

static int run(int argc, char **argv)
{
    static const struct {
        const char *name;
        int (*run)(int argc, char **argv);
    } parts[] = {
        {"check", rigcheck_run}, {"fit", rigfit_run}, {"new", rignew_run}, {"show", rigshow_run}};
    if (argc < 2)
        return command_usage(&command_rig, "check, show, new or fit?");
    for (size_t i = 0; i < sizeof parts / sizeof *parts; ++i)
        if (strcmp(argv[1], parts[i].name) == 0)
            return parts[i].run(argc - 1, argv + 1);
    return command_usage(&command_rig, "there is no \"rig %s\"", argv[1]);
}

const command command_rig = {
    .name = "rig",
    .summary = "check, show, draft and measure rigs",
    .help =
        "marotte rig check FILE.rig.json [--json]\n"
        "  Everything that a person should look at, errors first, with the place in the file.\n"
        "  Exit code 1 when there are errors.\n"
        "\n"
        "marotte rig show FILE.rig.json --out PICTURE.png [--yaw DEGREES] [--pitch DEGREES]\n"
        "                [--size WxH]\n"
        "  A picture from the front, from three quarters and from the side: what rides on which\n"
        "  bone as colour (pale: cannot be pulled), the contacts with their names, the axis of "
        "the\n"
        "  jaw. --yaw and --pitch: one view from there instead; yaw goes to the subject's left.\n"
        "\n"
        "marotte rig show FILE.rig.json --poses [--out PICTURE.png] [--yaw DEGREES] [--pitch "
        "DEGREES]\n"
        "                [--size WxH]\n"
        "  The rig's poses, a line each: the least determinant (above 0: no fold), how deep skin\n"
        "  is in the skull, the vertex furthest from rest. --out: a portrait of each.\n"
        "\n"
        "marotte rig new MESH [--out NAME.rig.json] [--unit mm|cm|m] [--force]\n"
        "  Drafts a rig for a mesh from its shape and the names of its parts, and says what a\n"
        "  person must confirm. --out: MESH's name with .rig.json. --force: over a file that is\n"
        "  there.\n"
        "\n"
        "marotte rig fit RIG.rig.json TARGETS.glb [--contacts SET] [--json] [--out FITTED.glb]\n"
        "                [--save-poses OUT.rig.json] [--suggest N]\n"
        "  Can the rig make the faces of the morph targets (same vertices as the rig's mesh)? For\n"
        "  each: the error that is left by the best bone poses and pulls of the contacts, "
        "relative\n"
        "  to the target, its worst vertex, how far rigid parts moved, how deep skin is in the\n"
        "  skull, the smallest Jacobian (above 0: no fold), and what the paper's unconstrained\n"
        "  warp leaves with the same contacts. --contacts: a name in the rig's contact_sets.\n"
        "  --out: the fitted faces as morph targets. --save-poses: the rig with a pose for each.\n"
        "  --suggest: proposes N contacts, in mirrored pairs, that would fit best.\n",
    .run = run};
