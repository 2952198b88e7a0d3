// Surfaces and rays in, hits out: text, so that a case can be looked at and replayed by hand.
//
//   surfaces N
//   then for each:  degree_u degree_v points_u points_v
//                   knots in u, knots in v, points "w*x w*y w*z w", v fastest
//   rays N
//   then for each:  origin, unit direction
//
// Out, a line a hit:      hit RAY SURFACE u v x y z
// a line a curve of hits: curve RAY SURFACE          (the ray runs inside the surface)
// a line a failure:       failed RAY SURFACE WHY
#pragma once

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <vector>

struct Surface {
    int degree[2];
    int points[2];
    std::vector<double> knots[2];
    std::vector<double> control; // homogeneous, v fastest

    bool rational() const {
        for (size_t k = 3; k < control.size(); k += 4) {
            if (control[k] != control[3]) return true;
        }
        return false;
    }
    const double *at(int i, int j) const { return &control[4 * (i * points[1] + j)]; }
};

struct Ray {
    double origin[3];
    double direction[3];
};

[[noreturn]] inline void fail(const char *what) {
    std::fprintf(stderr, "cannot read %s\n", what);
    std::exit(2);
}

inline int read_count(const char *word) {
    char found[32];
    int count;
    if (std::scanf("%31s %d", found, &count) != 2 || std::strcmp(found, word) != 0) fail(word);
    return count;
}

inline void read_numbers(double *numbers, size_t count, const char *what) {
    for (size_t k = 0; k < count; ++k) {
        if (std::scanf("%lf", &numbers[k]) != 1) fail(what);
    }
}

inline std::vector<Surface> read_surfaces() {
    std::vector<Surface> surfaces(read_count("surfaces"));
    for (Surface &surface : surfaces) {
        int *degree = surface.degree, *points = surface.points;
        if (std::scanf("%d %d %d %d", &degree[0], &degree[1], &points[0], &points[1]) != 4) {
            fail("degrees");
        }
        for (int k = 0; k < 2; ++k) {
            surface.knots[k].resize(points[k] + degree[k] + 1);
            read_numbers(surface.knots[k].data(), surface.knots[k].size(), "knots");
        }
        surface.control.resize(4 * size_t(points[0]) * size_t(points[1]));
        read_numbers(surface.control.data(), surface.control.size(), "points");
    }
    return surfaces;
}

inline std::vector<Ray> read_rays() {
    std::vector<Ray> rays(read_count("rays"));
    for (Ray &ray : rays) {
        read_numbers(ray.origin, 3, "an origin");
        read_numbers(ray.direction, 3, "a direction");
    }
    return rays;
}

inline void print_hit(size_t ray, size_t surface, const double uv[2], const double point[3]) {
    std::printf("hit %zu %zu %.17g %.17g %.17g %.17g %.17g\n", ray, surface, uv[0], uv[1], point[0],
                point[1], point[2]);
}
