# SPDX-License-Identifier: GPL-3.0-or-later
# The tables of `pinchlab analyse` once more, by base R, from the answers as `pinchlab study export --csv`
# writes them (or the answers.csv of a report):
#
#     Rscript analysis/reproduce.R answers.csv > tables.csv
#
# Two methods: demonstration, pinch, cable, share, exact p, Wilson interval; ties count for neither.
# Three and more: method, value on Bradley and Terry's scale, its interval by the cluster sandwich.
# Levels: series, answers, threshold, width, lapses and spread of the logistic function whose guesses are
# 1/2, as `pinchlab analyse` fits it unless options say otherwise.
answers <- read.csv(commandArgs(TRUE)[1], stringsAsFactors = FALSE)
if ("kind" %in% names(answers)) answers <- answers[answers$kind == "main", ]

two_methods <- function(d) {
  d <- d[d$choice != "tie", ]
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
  if (any(d$choice == "tie")) stop("ties need Davidson's model, which this script has not")
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

# Every participant has a threshold of their own, normal around the common one: integrated over a fine grid.
thresholds <- function(d) {
  s <- qlogis(0.95) - qlogis(0.05)
  u <- seq(-6, 6, length.out = 241)
  weight <- dnorm(u) / sum(dnorm(u))
  rows <- lapply(split(d, d$demonstration), function(one) {
    people <- split(one, one$participant)
    curve <- function(x) list(threshold = x[1], width = exp(x[2]), lapse = 0.1 * plogis(x[3]), spread = exp(x[4]))
    minus_log_likelihood <- function(x) {
      f <- curve(x)
      -sum(sapply(people, function(p) {
        z <- s * outer(p$level, f$threshold + f$spread * u, "-") / f$width
        own <- colSums(dbinom(p$correct, 1, 0.5 + (0.5 - f$lapse) * plogis(z), log = TRUE))
        max(own) + log(sum(weight * exp(own - max(own))))
      }))
    }
    range <- diff(range(one$level))
    start <- c(mean(one$level), log(range / 2), 0, log(range / 10))
    fit <- optim(start, minus_log_likelihood, method = "BFGS",
                 control = list(reltol = 1e-13, maxit = 500, parscale = c(range, 1, 1, 1)))
    data.frame(series = one$demonstration[1], answers = nrow(one), curve(fit$par))
  })
  do.call(rbind, rows)
}

table <- if ("level" %in% names(answers)) thresholds(answers) else if (all(c("left", "right") %in% names(answers))) scale(answers) else two_methods(answers)
write.csv(format(table, digits = 15), stdout(), row.names = FALSE, quote = FALSE)
