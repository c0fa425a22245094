/* check/wire.h - what the parent that starts cases and the child that runs them agree on: the names
 * of the cases, and how a case tells what it found: lines "KIND NAME TEXT\n" on descriptor WIRE_FD,
 * of printable bytes. The name has no blank. */
#ifndef MAROTTE_CHECK_WIRE_H
#define MAROTTE_CHECK_WIRE_H

/* ---- cases ---- */

#define CASE_TABLES       "tables" /* of the library */
#define CASE_TYPE         "type"
#define CASE_QUICK        "quick" /* tables, type and smoke of every type */
#define CASE_SMOKE        "smoke"
#define CASE_LIFE         "life"
#define CASE_DESTROY_NULL "destroy_null"
#define CASE_FACES        "faces"
#define CASE_GROWTH       "growth"
#define CASE_WALK         "walk"
#define CASE_RESTLESS     "restless"
#define CASE_HANDS        "hands"
#define CASE_ENGAGE       "engage"
#define CASE_DEADLINE     "deadline"
#define CASE_REPLAY       "replay"
#define CASE_SUM          "sum"
#define CASE_STATE        "state"
#define CASE_RESUME       "resume"
#define CASE_RIG_POSES    "rig_poses"
#define CASE_ABSENT       "absent"
#define CASE_INPUT        "input"
#define CASE_RECORDED     "recorded"
#define CASE_STOP         "stop"
#define CASE_DEVICES      "devices"
#define CASE_OUTPUT       "output"
#define CASE_FACE_OUTPUT  "face_output"

/* The child gives up by itself after WATCH_LIMIT_S of wall time, and can say where; the parent ends
 * it after CASE_LIMIT_S. */
enum { WATCH_LIMIT_S = 60, CASE_LIMIT_S = 75 };

/* ---- lines ---- */

enum { WIRE_FD = 3, WIRE_TEXT = 960, WIRE_LINE = 1024 };
enum {
    WIRE_OK = 'O',      /* NAME: a rule */
    WIRE_FAILED = 'F',  /* a rule */
    WIRE_SKIPPED = 'S', /* a rule */
    WIRE_FACT = 'I',    /* a name that parent and case agree on */
    WIRE_END = 'E'      /* the case came to its end */
};

/* ---- the names of facts ---- */

/* "INDEX CONCERNS ID": a type of the library. */
#define WIRE_TYPE "type"
/* A sum over all pulls of a take: the same in every process. */
#define WIRE_SUM "sum"

#endif
