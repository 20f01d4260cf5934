/* GraphDRL in C: plans walks that visit as many nodes of a graph as a budget allows, and bounds them.
 *
 * Handles are opaque; graphdrl_free() frees any of them. Every function that can fail gives a graphdrl_status, and
 * graphdrl_last_error() says in one line what was wrong. Nodes are numbers from 0 up; on a grid, row by row from the
 * upper left. Worlds and results do not change: any number of threads may use one. */
#ifndef GRAPHDRL_GRAPHDRL_C_H
#define GRAPHDRL_GRAPHDRL_C_H

#include <stddef.h>
#include <stdint.h>

#if defined(__GNUC__)
#define GRAPHDRL_API __attribute__((visibility("default")))
#else
#define GRAPHDRL_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* As the program's exit statuses. */
typedef enum graphdrl_status {
  GRAPHDRL_DONE = 0,
  GRAPHDRL_FAILED = 1,   /* not the caller's fault, such as memory that ran out or a full disk */
  GRAPHDRL_BAD_INPUT = 2 /* a bad argument or file */
} graphdrl_status;

typedef struct graphdrl_world graphdrl_world;
typedef struct graphdrl_result graphdrl_result;
typedef struct graphdrl_live graphdrl_live;

/* The version: "0.1.0". */
GRAPHDRL_API const char* graphdrl_version(void);

/* What went wrong last on this thread, one line; "" where nothing did. Holds until the next call that fails here. */
GRAPHDRL_API const char* graphdrl_last_error(void);

/* Frees a handle. Nothing happens with NULL. */
GRAPHDRL_API void graphdrl_free(void* handle);

/* How many threads one call may use, from 1 to 1024; 1 at first. Results do not depend on it. Not while another call is
 * under way. */
GRAPHDRL_API graphdrl_status graphdrl_set_threads(int32_t count);

/* ---- Worlds ---- */

/* A graph.
 * name: of pictures and errors; NULL for "graph". edges: [2 * edge_count], pairs of nodes; loops are left out, and of
 * parallel edges the cheapest stays. costs: [edge_count], finite, from 0 up; NULL for 1 each. directed: 0 where edges
 * lead both ways. blocked: [node_count], other than 0 where nobody may go; NULL for nowhere. prizes: [node_count], of
 * first visits, finite, from 0 up; NULL for 1 each. */
GRAPHDRL_API graphdrl_status graphdrl_world_from_edges(const char* name, int32_t node_count, size_t edge_count,
                                                       const int32_t* edges, const double* costs, int32_t directed,
                                                       const unsigned char* blocked, const double* prizes,
                                                       graphdrl_world** world);

/* A grid of cells. blocked: [rows * columns], row by row from the top, other than 0 where blocked. diagonals: other
 * than 0 for eight neighbours, where a diagonal step costs the square root of 2 and passes no blocked corner. */
GRAPHDRL_API graphdrl_status graphdrl_world_from_grid(const char* name, int32_t rows, int32_t columns,
                                                      const unsigned char* blocked, int32_t diagonals,
                                                      graphdrl_world** world);

/* A file in any format that the program reads, or "paper:a" to "paper:j". */
GRAPHDRL_API graphdrl_status graphdrl_world_from_file(const char* path, graphdrl_world** world);

/* For a NULL world these give "", 0, NULL or -1. */
GRAPHDRL_API const char* graphdrl_world_name(const graphdrl_world* world);
GRAPHDRL_API int32_t graphdrl_world_node_count(const graphdrl_world* world);  /* blocked ones included */
GRAPHDRL_API int32_t graphdrl_world_valid_count(const graphdrl_world* world); /* those that are not blocked */
/* What the file calls a node; NULL where it has no names, or no such node. */
GRAPHDRL_API const char* graphdrl_world_label(const graphdrl_world* world, int32_t node);
/* The node of a label, of "row,column" on a grid or of "#number"; -1 where there is no such valid node, and
 * graphdrl_last_error() says why. */
GRAPHDRL_API int32_t graphdrl_world_find(const graphdrl_world* world, const char* label);

/* ---- Plans ---- */

enum {
  GRAPHDRL_GIVEN = -1,    /* what the file says; else the first valid node as a start, and anywhere as an end */
  GRAPHDRL_ANYWHERE = -2, /* as an end */
  GRAPHDRL_AT_START = -3  /* as an end */
};

/* Called now and then, on the thread that plans. visited: nodes of the walk under way, or of the best one. bound:
 * infinite where there is none yet. Return non-zero to end this plan; graphdrl_plan() then gives the best walk so far.
 */
typedef int32_t (*graphdrl_progress)(int32_t visited, double bound, void* data);

/* What is asked. graphdrl_task_init() sets all of it; then set what differs. Later versions may add fields at its end.
 */
typedef struct graphdrl_task {
  size_t size;                /* of this struct, as the header of the caller has it */
  double budget;              /* in units of cost; below 0: what the file says */
  double relative;            /* above 0: instead, so many times the valid nodes, in edges of mean cost */
  int32_t start;              /* a node or GRAPHDRL_GIVEN */
  int32_t end;                /* a node, GRAPHDRL_GIVEN, GRAPHDRL_ANYWHERE or GRAPHDRL_AT_START */
  const char* policy;         /* as of --policy; NULL: the default of `graphdrl plan`, or of `graphdrl explore` */
  double time_limit_s;        /* seconds for the plan and its bound; below 0: none */
  uint64_t seed;              /* of the search; 1 at first */
  graphdrl_progress progress; /* or NULL */
  void* progress_data;
  /* An exploration, as `graphdrl explore` with --reveal, --score and --think-time: */
  const char* reveal;  /* what a visit shows: "edges", "radius:R" or "sight:R"; NULL: all is known beforehand */
  const char* score;   /* what counts, nodes "visited" or "seen"; NULL: visited */
  double think_time_s; /* seconds for each choice, of policies that plan; below 0: none */
  /* An old map, of which some may have changed, as of `graphdrl explore --believed`; NULL: there is none. Read while
   * graphdrl_plan() runs. */
  const graphdrl_world* believed;
} graphdrl_task;

/* Sets the fields that a struct of this size has. */
GRAPHDRL_API void graphdrl_task_init_sized(graphdrl_task* task, size_t size);

static inline void graphdrl_task_init(graphdrl_task* task) {
  graphdrl_task_init_sized(task, sizeof(graphdrl_task));
}

/* Plans one walk, and bounds it; or explores, where reveal is set. A budget of INFINITY explores until nothing is left
 * that is known. The result may outlive the world. */
GRAPHDRL_API graphdrl_status graphdrl_plan(const graphdrl_world* world, const graphdrl_task* task,
                                           graphdrl_result** result);

/* What no walk's prize exceeds: nodes, where there are no prizes. Looks at budget, start, end and time limit. */
GRAPHDRL_API graphdrl_status graphdrl_upper_bound(const graphdrl_world* world, const graphdrl_task* task,
                                                  double* bound);

/* For a NULL result these give 0, NULL or "". */
/* Every step, the start first; it lives as long as the result. length: set to how many, where it is not NULL. */
GRAPHDRL_API const int32_t* graphdrl_result_walk(const graphdrl_result* result, size_t* length);
GRAPHDRL_API int32_t graphdrl_result_visited(const graphdrl_result* result); /* valid nodes, the start included */
GRAPHDRL_API double graphdrl_result_prize(const graphdrl_result* result);    /* of all nodes visited, or seen */
GRAPHDRL_API double graphdrl_result_cost(const graphdrl_result* result);
GRAPHDRL_API double graphdrl_result_budget(const graphdrl_result* result); /* in units of cost */
/* No walk has a higher prize, knowing the map; infinite where nodes seen count. */
GRAPHDRL_API double graphdrl_result_bound(const graphdrl_result* result);
GRAPHDRL_API int32_t
graphdrl_result_optimal(const graphdrl_result* result); /* 1 if proved: no walk has a higher prize */
/* Of an exploration the nodes seen, in the order in which they were seen, and how many were seen at each step of the
 * walk; of other plans NULL. As the walk. */
GRAPHDRL_API const int32_t* graphdrl_result_seen(const graphdrl_result* result, size_t* length);
GRAPHDRL_API const int32_t* graphdrl_result_seen_after_step(const graphdrl_result* result, size_t* length);
/* The document of `graphdrl plan --json`, or of `graphdrl explore --json`; it lives as long as the result. "" if memory
 * ran out. */
GRAPHDRL_API const char* graphdrl_result_json(const graphdrl_result* result);
/* Writes it in the format of the ending, as `graphdrl plan --out`. */
GRAPHDRL_API graphdrl_status graphdrl_result_save(const graphdrl_result* result, const char* path);

/* ---- Live explorations ---- */

/* An exploration of something that can say in which state it is and which moves it has, step by step. Messages and
 * answers are JSON objects; docs/live.md has all of them. One thread at a time; any number may be under way.
 * options: those of `open`, as {"cover": "edges", "reset_cost": 1}; NULL for the defaults. transcript: a file in which
 * each message is written down with its answer; NULL for none. resume: other than 0 to go on where it ends, with its
 * options. */
GRAPHDRL_API graphdrl_status graphdrl_live_begin(const char* options, const char* transcript, int32_t resume,
                                                 graphdrl_live** live);
/* answer: what to do next, or {"error": …} for a message that is refused; valid until the next call with this handle. A
 * transcript that cannot be written to is GRAPHDRL_FAILED. */
GRAPHDRL_API graphdrl_status graphdrl_live_answer(graphdrl_live* live, const char* message, const char** answer);
/* Writes the map discovered (.graphml, .dot, .json), or the walk through it in the format of another ending. */
GRAPHDRL_API graphdrl_status graphdrl_live_save(const graphdrl_live* live, const char* path);

#ifdef __cplusplus
}
#endif

#endif /* GRAPHDRL_GRAPHDRL_C_H */
