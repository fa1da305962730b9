# SPDX-License-Identifier: GPL-3.0-or-later
# The tables of `pinchlab analyse` once more, by base R, from the answers as `pinchlab study export --csv`
# writes them (or the answers.csv of a report):
#
#     Rscript analysis/reproduce.R answers.csv > tables.csv
#
# Two methods: demonstration, pinch, cable, share, exact p, Wilson interval.
# Three and more: method, value on Bradley and Terry's scale, its interval by the cluster sandwich.
answers <- read.csv(commandArgs(TRUE)[1], stringsAsFactors = FALSE)
if ("kind" %in% names(answers)) answers <- answers[answers$kind == "main", ]

two_methods <- function(d) {
  rows <- lapply(split(d, d$demonstration), function(one) {
    k <- sum(one$choice == "pinch")
    n <- nrow(one)
    wilson <- suppressWarnings(prop.test(k, n, correct = FALSE)$conf.int)
    data.frame(demonstration = one$demonstration[1], pinch = k, cable = n - k, share = k / n,
               p = binom.test(k, n)$p.value, low = wilson[1], high = wilson[2])
  })
  do.call(rbind, rows)
}

scale <- function(d) {
  methods <- sort(unique(c(d$left, d$right)))
  x <- outer(d$left, methods, "==") - outer(d$right, methods, "==")
  fit <- glm(as.numeric(d$choice == d$left) ~ x[, -1] - 1, family = binomial,
             control = list(epsilon = 1e-14))
  scores <- rowsum(x[, -1] * (fit$y - fitted(fit)), d$participant)
  n <- nrow(scores)
  bread <- summary(fit)$cov.unscaled
  covariance <- bread %*% crossprod(scores) %*% bread * n / (n - 1)
  m <- length(methods)
  centre <- (diag(m) - 1 / m)[, -1]
  value <- as.vector(centre %*% coef(fit))
  half <- qt(0.975, n - 1) * sqrt(diag(centre %*% covariance %*% t(centre)))
  data.frame(method = methods, value = value, low = value - half, high = value + half)
}

table <- if (all(c("left", "right") %in% names(answers))) scale(answers) else two_methods(answers)
write.csv(format(table, digits = 15), stdout(), row.names = FALSE, quote = FALSE)
