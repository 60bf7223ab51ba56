
/* Base parameters: of each link, with what the links beyond hand down to it, second moments xx ... yz, first moments hx, hy,
 * net mass n and its first moments nx ... nz (mass less displaced fluid); gravity in base_link. */
typedef struct {
$members
} alpha5_parameters;

/* Those of the arm as it was generated. */
extern const alpha5_parameters alpha5_default_parameters;
