/* show/pack.h: a show travels with its faces; a pack is only data, whoever made it. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "show/hash.h"
#include "show/pack.h"

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

typedef struct stand {
    char folder[64], show[PATH_MAX], face[PATH_MAX], key[PATH_MAX]; /* key: of the packed face */
    char rig[PATH_MAX];
    take_performance p;
} stand;

__attribute__((format(printf, 3, 4))) static void put(const stand *s, const char *text,
                                                      const char *format, ...)
{
    char path[PATH_MAX];
    va_list arguments;
    int length = snprintf(path, sizeof path, "%s/", s->folder);
    va_start(arguments, format);
    (void)vsnprintf(path + length, sizeof path - (size_t)length, format, arguments);
    va_end(arguments);
    FILE *file = fopen(path, "wb");
    if (!file)
        fail_msg("%s", path);
    assert_int_equal(fwrite(text, 1, strlen(text), file), strlen(text));
    assert_int_equal(fclose(file), 0);
}

static void run(const stand *s, const char *command)
{
    char line[PATH_MAX * 3];
    (void)snprintf(line, sizeof line, "cd %s && %s", s->folder, command);
    assert_int_equal(system(line), 0);
}

static const char rig_text[] = "{\"include\": [\"more/lids.rig.json\"], \"mesh\": \"head.gltf\"}";
static const char mesh_text[] =
    "{\"buffers\": [{\"uri\": \"head.bin\"}, {\"uri\": \"data:x,y\"}],"
    " \"images\": [{\"uri\": \"pictures/a%20skin.png\"}, {\"bufferView\": 0}]}";

static void know_hashes(stand *s)
{
    hash_bytes(s->p.rig_hash, rig_text, strlen(rig_text));
    hash_bytes(s->p.mesh_hash, mesh_text, strlen(mesh_text));
    (void)snprintf(s->key, sizeof s->key, "night.pack/%.16s-%.16s", s->p.rig_hash, s->p.mesh_hash);
}

static int set_up(void **state)
{
    stand *s = calloc(1, sizeof *s);
    (void)snprintf(s->folder, sizeof s->folder, "/tmp/pack.XXXXXX");
    assert_non_null(mkdtemp(s->folder));
    (void)snprintf(s->show, sizeof s->show, "%s/night.marotte", s->folder);
    (void)snprintf(s->rig, sizeof s->rig, "%s/rig/head.rig.json", s->folder);
    s->p.rig = s->rig;
    run(s, "mkdir -p rig/more rig/pictures");
    put(s, rig_text, "rig/head.rig.json");
    put(s, "{\"mesh\": \"../head.gltf\"}", "rig/more/unused.json");
    put(s, "{}", "rig/more/lids.rig.json");
    put(s, mesh_text, "rig/head.gltf");
    put(s, "numbers", "rig/head.bin");
    put(s, "picture", "rig/pictures/a skin.png");
    put(s, "mine", "rig/secret.txt");
    know_hashes(s);
    *state = s;
    return 0;
}

static int tear_down(void **state)
{
    stand *s = *state;
    run(s, "cd / && rm -rf \"$OLDPWD\"");
    free(s);
    return 0;
}

static void pack(stand *s)
{
    error err = {""};
    if (pack_add(s->show, &s->p, &err) != MRT_OK)
        fail_msg("%s", err.text);
}

static void expect_found(stand *s)
{
    error err = {""};
    if (pack_find(s->face, s->show, &s->p, &err) != MRT_OK)
        fail_msg("%s", err.text);
}

static void expect_refused(stand *s, const char *why)
{
    error err = {""};
    char path[PATH_MAX] = "";
    assert_true(pack_find(path, s->show, &s->p, &err) < 0);
    if (!strstr(err.text, why))
        fail_msg("\"%s\" instead of \"%s\"", err.text, why);
    assert_string_equal(path, "");
}

static void a_face_travels_with_all_that_it_is_read_from(void **state)
{
    stand *s = *state;
    error err = {""};
    assert_int_equal(pack_find(s->face, s->show, &s->p, &err), MRT_END);
    pack(s);
    assert_int_equal(pack_add(s->show, &s->p, &err), MRT_END);
    run(s, "rm -r rig && mkdir elsewhere && mv night.pack elsewhere/");
    (void)snprintf(s->show, sizeof s->show, "%s/elsewhere/night.marotte", s->folder);
    expect_found(s);
    assert_non_null(strstr(s->face, "/elsewhere/night.pack/"));
    run(s,
        "cd elsewhere/*/*/ && [ \"$(find . -type f | sort | xargs -d '\\n')\" = './face.rig.json "
        "./files.json ./head.bin ./head.gltf ./more/lids.rig.json ./pictures/a skin.png' ]");
    char copy[PATH_MAX];
    (void)snprintf(copy, sizeof copy, "%s/saved.marotte", s->folder);
    assert_int_equal(pack_copy(s->show, copy, &s->p, &err), MRT_OK);
    run(s, "diff -r saved.pack elsewhere/night.pack");
}

/* A face alone keeps its kind; another face of the same show stands beside it. */
static void a_mesh_alone_travels_beside_a_rig(void **state)
{
    stand *s = *state;
    pack(s);
    (void)snprintf(s->rig, sizeof s->rig, "%s/rig/head.gltf", s->folder);
    s->p.rig_hash[0] = '\0';
    pack(s);
    run(s, "rm -r rig");
    expect_found(s);
    assert_non_null(strstr(s->face, "/face.gltf"));
}

/* As its reader finds them, and no more. */
static void an_obj_travels_with_materials_and_pictures(void **state)
{
    stand *s = *state;
    static const char obj[] = "mtllib mat/my.mtl\nmtllib gone.mtl\nv 0 0 0\n";
    pack(s);
    put(s, obj, "rig/head.obj");
    run(s, "mkdir rig/mat");
    put(s, "newmtl a\nmap_Kd D:\\eye.png\nmap_Ke gone.png\nmap_d ../secret.txt\n",
        "rig/mat/my.mtl");
    put(s, "picture", "rig/mat/eye.png");
    (void)snprintf(s->rig, sizeof s->rig, "%s/rig/head.obj", s->folder);
    s->p.rig_hash[0] = '\0';
    hash_bytes(s->p.mesh_hash, obj, strlen(obj));
    pack(s);
    run(s, "rm -r rig");
    expect_found(s);
    run(s, "cd \"$(dirname \"$(find night.pack -name face.obj)\")\" && "
           "[ \"$(find . -type f | sort | xargs)\" = './face.obj ./files.json ./mat/eye.png "
           "./mat/my.mtl' ]");
}

static void what_is_not_what_was_performed_on_is_not_packed(void **state)
{
    stand *s = *state;
    error err = {""};
    put(s, "{\"mesh\": \"head.gltf\", \"unit\": 2}", "rig/head.rig.json");
    assert_true(pack_add(s->show, &s->p, &err) < 0);
    assert_non_null(strstr(err.text, "has changed since it was performed"));
    put(s, rig_text, "rig/head.rig.json");
    put(s, "{}", "rig/head.gltf");
    assert_true(pack_add(s->show, &s->p, &err) < 0);
    run(s, "rm rig/more/lids.rig.json");
    assert_true(pack_add(s->show, &s->p, &err) < 0);
    assert_non_null(strstr(err.text, "lids.rig.json"));
    run(s, "[ ! -e night.pack ]");
}

static void files_outside_of_the_faces_folder_do_not_travel(void **state)
{
    static const char *const outside[] = {"../a.bin",     "/etc/hostname", "more/../../a.bin",
                                          "%2e%2e/a.bin", ".hidden",       "a\\\\b"};
    stand *s = *state;
    put(s, "numbers", "a.bin");
    for (size_t i = 0; i < sizeof outside / sizeof outside[0]; ++i) {
        char text[200];
        error err = {""};
        (void)snprintf(text, sizeof text, "{\"buffers\": [{\"uri\": \"%s\"}]}", outside[i]);
        put(s, text, "rig/head.gltf");
        assert_true(pack_add(s->show, &s->p, &err) < 0);
        if (!strstr(err.text, "in or below the folder of the face"))
            fail_msg("%s: %s", outside[i], err.text);
    }
    error err = {""};
    put(s, mesh_text, "rig/head.gltf");
    run(s, "mv rig/head.bin .. && ln -s ../../head.bin rig/head.bin");
    assert_true(pack_add(s->show, &s->p, &err) < 0);
    run(s, "rm -f ../head.bin; [ ! -e night.pack ]");
}

/* Bytes that changed, files that are gone, links and pipes in their place. */
static void a_pack_that_was_tampered_with_is_refused(void **state)
{
    static const struct {
        const char *command, *why;
    } tampered[] = {
        {"printf Numbers >head.bin", "differs from the packed file"},
        {"printf '{}' >face.rig.json", "differs from the packed file"},
        {"rm head.gltf", "head.gltf"},
        {"rm files.json", "files.json"},
        {"printf '{' >files.json", "not the file list"},
        {"rm head.bin && ln -s ../../rig/head.bin head.bin", "head.bin"},
        {"rm -r more && ln -s ../../rig/more more", "more"},
        {"rm head.bin && mkfifo head.bin", "head.bin"},
        {"rm head.bin && mkdir head.bin", "head.bin"},
        {"cp files.json x && rm files.json && ln -s x files.json", "files.json"},
        {"sed -i 's/face.rig/other.rig/' files.json && mv face.rig.json other.rig.json",
         "has no face.rig.json"},
        {"k=$(basename $PWD) && cd .. && mv $k x && ln -s x $k",
         "does not have the performed face"},
        {"cd ../.. && mv night.pack x && ln -s x night.pack", "links are not followed"},
        {"cd ../.. && rm -r night.pack && mkfifo night.pack", "not a folder"},
    };
    stand *s = *state;
    for (size_t i = 0; i < sizeof tampered / sizeof tampered[0]; ++i) {
        char line[PATH_MAX * 2];
        pack(s);
        expect_found(s);
        (void)snprintf(line, sizeof line, "cd %s && %s", s->key, tampered[i].command);
        run(s, line);
        expect_refused(s, tampered[i].why);
        run(s, "rm -rf night.pack x");
    }
}

static void names_in_a_list_lead_nowhere(void **state)
{
    static const char *const names[] = {
        "../../rig/secret.txt", "/etc/passwd", "more/../../x", "", ".", "..", "more/", "more//x",
        "\\u001b[2J",           "x\\\\y",      "\\u0000"};
    stand *s = *state;
    char hash[TAKE_HASH];
    hash_bytes(hash, "mine", 4);
    pack(s);
    for (size_t i = 0; i < sizeof names / sizeof names[0]; ++i) {
        char text[400];
        (void)snprintf(text, sizeof text, "{\"marotte_pack\": 1, \"files\": {\"%s\": \"%s\"}}",
                       names[i], hash);
        put(s, text, "%s/files.json", s->key);
        expect_refused(s, "files.json");
    }
}

/* More files than a face may have, a list that is larger than any, and what a show may say. */
static void nothing_costs_without_measure(void **state)
{
    stand *s = *state;
    char *text = calloc(1, 4 << 20);
    assert_non_null(text);
    size_t used = (size_t)sprintf(text, "{\"marotte_pack\": 1, \"files\": {");
    for (int i = 0; i <= PACK_FILES_MAX; ++i)
        used += (size_t)sprintf(text + used, "%s\"f%d\": \"%s\"", i ? ", " : "", i, s->p.mesh_hash);
    (void)sprintf(text + used, "}}");
    pack(s);
    put(s, text, "%s/files.json", s->key);
    expect_refused(s, "not the file list");
    memset(text, ' ', (4 << 20) - 1);
    put(s, text, "%s/files.json", s->key);
    expect_refused(s, "files.json");
    free(text);
    run(s, "rm -r night.pack");
    pack(s);
    run(s, "truncate -s 2G night.pack/*/head.bin");
    expect_refused(s, "too large");
    (void)snprintf(s->p.mesh_hash, sizeof s->p.mesh_hash, "../../rig");
    expect_refused(s, "does not name the face");
}

static void a_full_disk_leaves_no_half_face(void **state)
{
    stand *s = *state;
    error err = {""};
    const struct rlimit none = {16, RLIM_INFINITY};
    struct rlimit before;
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &before), 0);
    void (*handler)(int) = signal(SIGXFSZ, SIG_IGN);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &none), 0);
    mrt_result result = pack_add(s->show, &s->p, &err);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &before), 0);
    (void)signal(SIGXFSZ, handler);
    assert_true(result < 0);
    run(s, "[ ! -e night.pack ]");
    put(s, "mine", "night.pack");
    assert_true(pack_add(s->show, &s->p, &err) < 0); /* a folder that is a file */
    run(s, "[ \"$(cat night.pack)\" = mine ]");
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(a_face_travels_with_all_that_it_is_read_from),
        TEST(a_mesh_alone_travels_beside_a_rig),
        TEST(an_obj_travels_with_materials_and_pictures),
        TEST(what_is_not_what_was_performed_on_is_not_packed),
        TEST(files_outside_of_the_faces_folder_do_not_travel),
        TEST(a_pack_that_was_tampered_with_is_refused),
        TEST(names_in_a_list_lead_nowhere),
        TEST(nothing_costs_without_measure),
        TEST(a_full_disk_leaves_no_half_face),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
