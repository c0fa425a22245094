#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "base/angle.h"
#include "puppet_face.h"

#include <math.h>

/* The measures of rigs/making.md, mm. */
static const vec3 EYE = {37.5, 68.0, 62.0};
static const vec3 HINGE = {68.0, -24.0, -8.0};

static void bag_hangs_behind_the_lips(void **state)
{
    (void)state;
    uint8_t *lips = vertices_of("skin.lips"), *bag = vertices_of("mouth_bag");
    int shared_count = 0;
    for (uint32_t v = 0; v < face.vertex_count; ++v)
        shared_count += lips[v] && bag[v];
    assert_int_equal(shared_count, 84);
    free(lips);
    free(bag);
}

/* Along edges; Bellman and Ford's, as far as it changes anything. */
static double way_mm(uint32_t from, uint32_t to)
{
    double *way = malloc(face.vertex_count * sizeof *way);
    assert_non_null(way);
    for (uint32_t v = 0; v < face.vertex_count; ++v)
        way[v] = v == from ? 0.0 : 1e30;
    for (int is_changed = 1; is_changed;) {
        is_changed = 0;
        for (uint32_t v = 0; v < face.vertex_count; ++v)
            for (uint32_t k = net.neighbour_start[v]; k < net.neighbour_start[v + 1]; ++k) {
                double through =
                    way[net.neighbour[k]] + distance(point_of(v), point_of(net.neighbour[k]));
                if (through < way[v]) {
                    way[v] = through;
                    is_changed = 1;
                }
            }
    }
    double out = way[to];
    free(way);
    return out;
}

/* Of the lips, in the middle: below (sign -1) or above the slit. */
static uint32_t rim_vertex(double sign)
{
    uint8_t *lips = vertices_of("skin.lips");
    uint32_t best = 0;
    double least_mm = (double)INFINITY;
    for (uint32_t v = 0; v < face.vertex_count; ++v) {
        vec3 p = point_of(v);
        double away_mm = sign * (p.y + 38.0);
        if (lips[v] && fabs(p.x) < 1e-6 && p.z > 60.0 && away_mm > 0.0 && away_mm < least_mm) {
            least_mm = away_mm;
            best = v;
        }
    }
    free(lips);
    return best;
}

static void lips_are_close_but_joined_only_by_long_ways(void **state)
{
    (void)state;
    uint32_t upper = rim_vertex(1.0), lower = rim_vertex(-1.0);
    assert_true(distance(point_of(upper), point_of(lower)) < 0.2);
    assert_true(way_mm(upper, lower) > 100.0);
}

static void check_shell(const char *name, double low_mm, double high_mm)
{
    uint8_t *used = vertices_of(name);
    int is_left = strstr(name, ".r") == NULL;
    vec3 centre = {is_left ? EYE.x : -EYE.x, EYE.y, EYE.z};
    for (uint32_t v = 0; v < face.vertex_count; ++v) {
        double from_mm = distance(point_of(v), centre);
        assert_true(!used[v] || (from_mm > low_mm - 0.1 && from_mm < high_mm + 0.1));
    }
    free(used);
}

static void lids_are_shells_around_the_balls(void **state)
{
    (void)state;
    check_shell("eye.l", 25.0, 25.0);
    check_shell("eye.r.iris", 25.0, 25.0);
    check_shell("eye.l.pupil", 25.0, 25.0);
    check_shell("lid_upper.l", 25.9, 27.6);
    check_shell("lid_upper.r", 25.9, 27.6);
    check_shell("lid_lower.l", 25.9, 27.6);
    check_shell("lid_lower.r", 25.9, 27.6);
    check_shell("lid_upper.l.lash", 25.9, 28.8);
    check_shell("lid_upper.r.lash", 25.9, 28.8);
    check_shell("lid_lower.l.lash", 25.9, 28.1);
    check_shell("lid_lower.r.lash", 25.9, 28.1);
}

/* How far the edge of a lid's lash stands above the middle of the left ball, seen from the side. */
static double edge_deg(const char *name, double sign)
{
    uint8_t *used = vertices_of(name);
    double edge = 180.0;
    for (uint32_t v = 0; v < face.vertex_count; ++v) {
        vec3 from = vec3_sub(point_of(v), EYE);
        if (used[v] && fabs(from.x) < 5.0)
            edge = fmin(edge, sign * atan2(from.y, from.z) * 57.29577951308232);
    }
    free(used);
    return sign * edge;
}

/* The upper lid by 50 degrees, the lower one by 20. */
static void lids_meet_when_they_close(void **state)
{
    (void)state;
    double upper = edge_deg("lid_upper.l.lash", 1.0);
    double lower = edge_deg("lid_lower.l.lash", -1.0);
    assert_true(upper > 30.0 && lower < -25.0);
    assert_true(upper - 50.0 <= lower + 20.0);
    assert_true(upper - 45.0 > lower + 20.0);
}

/* After a turn of the jaw about the hinge, a slide and a shift. */
static double clearance_mm(double open_deg, vec3 shift)
{
    static const char *const ROW[2][2] = {{"teeth_upper", "teeth_upper.gum"},
                                          {"teeth_lower", "teeth_lower.gum"}};
    rigid jaw = rigid_turn(HINGE, (vec3){1, 0, 0}, open_deg * (ANGLE_PI / 180.0));
    double upper = (double)INFINITY, lower = -(double)INFINITY;
    for (int row = 0; row < 2; ++row)
        for (int i = 0; i < 2; ++i) {
            uint8_t *used = vertices_of(ROW[row][i]);
            for (uint32_t v = 0; v < face.vertex_count; ++v) {
                if (!used[v])
                    continue;
                if (row == 0)
                    upper = fmin(upper, point_of(v).y);
                else
                    lower = fmax(lower, vec3_add(rigid_apply(&jaw, point_of(v)), shift).y);
            }
            free(used);
        }
    return upper - lower;
}

/* A level plane stays between the rows: no motion sideways or forwards can bring them together. */
static void lower_teeth_clear_the_upper_ones(void **state)
{
    (void)state;
    for (double open_deg = 0.0; open_deg <= 32.0; open_deg += 4.0)
        for (double side_mm = -10.0; side_mm <= 10.0; side_mm += 5.0)
            for (double forward_mm = 0.0; forward_mm <= 8.0; forward_mm += 4.0)
                assert_true(clearance_mm(open_deg, (vec3){side_mm, 0.0, forward_mm}) > 2.0);
}

static void incisors_part_by_45_to_55_mm(void **state)
{
    (void)state;
    uint8_t *lower = vertices_of("teeth_lower");
    vec3 incisor = {0, -1000, 0};
    for (uint32_t v = 0; v < face.vertex_count; ++v)
        if (lower[v] && fabs(point_of(v).x) < 1e-3 && point_of(v).y > incisor.y)
            incisor = point_of(v);
    free(lower);
    rigid jaw = rigid_turn(HINGE, (vec3){1, 0, 0}, 32.0 * (ANGLE_PI / 180.0));
    double moved_mm = distance(incisor, rigid_apply(&jaw, incisor));
    assert_true(moved_mm > 45.0 && moved_mm < 55.0);
}

static void bones_are_marked_apart(void **state)
{
    (void)state;
    const float *skull = attribute_named("_SKULL"), *jaw = attribute_named("_JAW");
    uint8_t *lower = vertices_of("teeth_lower"), *upper = vertices_of("teeth_upper");
    uint8_t *skin = vertices_of("skin");
    int chin_count = 0, cranium_count = 0;
    for (uint32_t v = 0; v < face.vertex_count; ++v) {
        assert_true(skull[v] == 0.0f || skull[v] == 1.0f);
        assert_true(jaw[v] == 0.0f || jaw[v] == 1.0f);
        assert_true(skull[v] * jaw[v] == 0.0f);
        assert_true(!lower[v] || jaw[v] == 1.0f);
        assert_true(!upper[v] || skull[v] == 1.0f);
        assert_true(!net.on_border[v] || !skin[v] || skull[v] == 1.0f);
        chin_count += skin[v] && jaw[v] > 0.5f;
        cranium_count += skin[v] && skull[v] > 0.5f;
    }
    assert_in_range(chin_count, 200, 2000);
    assert_in_range(cranium_count, 2000, 7000);
    free(lower);
    free(upper);
    free(skin);
}

/* The point of a triangle that is nearest to p, by the sides and the plane. */
static double from_triangle_mm(vec3 p, uint32_t triangle)
{
    vec3 a = corner_of(triangle, 0);
    vec3 u = vec3_sub(corner_of(triangle, 1), a), v = vec3_sub(corner_of(triangle, 2), a);
    vec3 normal = vec3_cross(u, v), from = vec3_sub(p, a);
    double square = vec3_dot(normal, normal);
    double s = vec3_dot(vec3_cross(from, v), normal) / square;
    double t = vec3_dot(vec3_cross(u, from), normal) / square;
    if (s >= 0.0 && t >= 0.0 && s + t <= 1.0)
        return fabs(vec3_dot(from, normal)) / sqrt(square);
    double least = 1e30;
    for (uint32_t k = 0; k < 3; ++k) {
        vec3 start = corner_of(triangle, k);
        vec3 side = vec3_sub(corner_of(triangle, (k + 1) % 3), start);
        double at = vec3_dot(vec3_sub(p, start), side) / vec3_dot(side, side);
        at = fmax(0.0, fmin(1.0, at));
        least = fmin(least, distance(p, vec3_add(start, vec3_scale(side, at))));
    }
    return least;
}

/* The least distance from a vertex of the one part to the other's surface. */
static double air_mm(const char *from, const char *to)
{
    const mesh_part *other = part_named(to);
    uint8_t *used = vertices_of(from);
    double least_mm = 1e30;
    for (uint32_t v = 0; v < face.vertex_count; ++v) {
        vec3 p = point_of(v);
        if (!used[v] || p.x < 0.0)
            continue;
        for (uint32_t t = 0; t < other->triangle_count; ++t)
            if (distance(p, corner_of(other->first_triangle + t, 0)) < least_mm + 15.0)
                least_mm = fmin(least_mm, from_triangle_mm(p, other->first_triangle + t));
    }
    free(used);
    return least_mm;
}

static void teeth_have_air_around_them(void **state)
{
    (void)state;
    static const char *const ROW[] = {"teeth_upper", "teeth_upper.gum", "teeth_lower",
                                      "teeth_lower.gum"};
    for (size_t i = 0; i < sizeof ROW / sizeof *ROW; ++i) {
        assert_true(air_mm(ROW[i], "skin.lips") > 1.5 && air_mm(ROW[i], "mouth_bag") > 1.5);
        assert_true(air_mm("skin.lips", ROW[i]) > 1.5 && air_mm("mouth_bag", ROW[i]) > 1.5);
    }
}

/* Of its section's 16 points 7 lie at the bottom; none is further out than it is thick. */
static void brows_lie_on_the_skin(void **state)
{
    (void)state;
    const mesh_part *skin = part_named("skin");
    uint8_t *brow = vertices_of("brow.l");
    int bottom_count = 0, count = 0;
    for (uint32_t v = 0; v < face.vertex_count; ++v) {
        if (!brow[v])
            continue;
        double least_mm = 1e30;
        for (uint32_t t = 0; t < skin->triangle_count; ++t)
            if (distance(point_of(v), corner_of(skin->first_triangle + t, 0)) < 15.0)
                least_mm = fmin(least_mm, from_triangle_mm(point_of(v), skin->first_triangle + t));
        assert_true(least_mm > 0.2 && least_mm < 7.5);
        bottom_count += least_mm < 1.5;
        ++count;
    }
    assert_true(16 * bottom_count >= 7 * (count - 40));
    free(brow);
}

/* The ellipsoids that rigs/making.md suggests as the skull. */
static void skull_lies_under_the_skin(void **state)
{
    (void)state;
    static const vec3 CENTRE[] = {{0, 40, -30}, {0, 104, 10}, {58, 12, 30}, {-58, 12, 30}};
    static const vec3 RADIUS[] = {{80, 78, 60}, {56, 16, 38}, {26, 18, 26}, {26, 18, 26}};
    uint8_t *skin = vertices_of("skin"), *bag = vertices_of("mouth_bag");
    for (uint32_t v = 0; v < face.vertex_count; ++v)
        for (size_t i = 0; i < sizeof CENTRE / sizeof *CENTRE; ++i) {
            vec3 d = vec3_sub(point_of(v), CENTRE[i]);
            vec3 q = {d.x / RADIUS[i].x, d.y / RADIUS[i].y, d.z / RADIUS[i].z};
            assert_true(vec3_length(q) > 1.02 || (!skin[v] && !bag[v]));
        }
    free(skin);
    free(bag);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bag_hangs_behind_the_lips),
        cmocka_unit_test(lips_are_close_but_joined_only_by_long_ways),
        cmocka_unit_test(lids_are_shells_around_the_balls),
        cmocka_unit_test(lids_meet_when_they_close),
        cmocka_unit_test(teeth_have_air_around_them),
        cmocka_unit_test(brows_lie_on_the_skin),
        cmocka_unit_test(lower_teeth_clear_the_upper_ones),
        cmocka_unit_test(incisors_part_by_45_to_55_mm),
        cmocka_unit_test(bones_are_marked_apart),
        cmocka_unit_test(skull_lies_under_the_skin),
    };
    return cmocka_run_group_tests(tests, read_puppet, forget_puppet);
}
